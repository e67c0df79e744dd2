// SPDX-License-Identifier: Apache-2.0
// relume precompute: tensors, from which pictures are replayed.
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/progress.h"
#include "budget.h"
#include "driver/edit_groups.h"
#include "driver/precompute_relight.h"
#include "driver/ranks.h"
#include "driver/stop.h"
#include "precompute.h"
#include "scene_options.h"
#include "subcommand.h"

// What only some kinds of tensor have options for: headings of --help.
#define RELIGHT "precompute relight"
#define EDIT "precompute edit"
#define EDIT_BOUNCES "precompute edit, all bounces"
#define EDIT_DIRECT "precompute edit --direct"

#define AT(member) offsetof(struct precompute_values, member)

static const struct option_argument arguments[] = {
    {"KIND", AT(kind), "relight: how the picture depends on its lighting; edit: on its materials",
     false, false},
    {"SCENE", AT(scene), "scene (.xml, .pbrt) or model (.gltf, .glb, .obj)", false, false},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(output),
     .argument = "T.safetensors", .help = "the tensor to write", .required = true},
    OPTION_GROUP(RELIGHT),
    {.name = "basis", .type = OPTION_TEXT, .offset = AT(basis), .argument = "NAME", .def = "lights",
     .help = "lights: a coefficient per emitter or `group` name;\n"
             "pixels:WxH: per cell of a latitude-longitude grid of directions;\n"
             "sh:N: spherical harmonics to order N;\n"
             "haar:WxH, daub4:WxH: wavelets over the cells"},
    OPTION_GROUP(EDIT),
    {.name = "edit", .type = OPTION_TEXTS, .offset = AT(edit), .argument = "NAME",
     .help = "make the material, or that of the shape, of this id editable, too"},
    {.name = "budget", .type = OPTION_TEXT, .offset = AT(budget), .argument = "relmse=X",
     .help = "" BUDGET_HELP "; drops what\n--time and --noise would keep to go on"},
    {.name = "light", .type = OPTION_TEXT, .offset = AT(light), .argument = "NAME",
     .help = "light of this emitter alone, or of this `group` of them: a tensor for each,\n"
             "and `relume edit` edits lights and materials together"},
    OPTION_GROUP(EDIT_BOUNCES),
    {.name = "bounces", .type = OPTION_INT, .offset = AT(bounces), .argument = "N", .min = 1,
     .max = EDIT_MOST_BOUNCES, .def = "4",
     .help = "how often light scatters from materials that can be edited"},
    {.name = "series", .type = OPTION_TEXT, .offset = AT(series), .argument = "J,J2,1,...",
     .def = "64", .help = "most bins of a curve where the eye sees it, at the second hop, ...;\n"
     "1, where none is given: an albedo"},
    {.name = "group", .type = OPTION_TEXTS, .offset = AT(group), .argument = "NAME=OBJ,OBJ,...",
     .help = "these have one mean albedo at later hops, since tensors grow with products\n"
             "of albedos; N: all but the N - 1 that pass most light on are a group"},
    {.name = "tail", .type = OPTION_TEXT, .offset = AT(tail), .argument = "NAME", .def = "frozen",
     .help = "light of more bounces meets the materials as they are (frozen),\n"
     "is left out (none), or comes from the ratio of the last two bounces (geometric)"},
    {.name = "later", .type = OPTION_TEXT, .offset = AT(later), .argument = "NAME",
     .def = "kept", .help = "at later hops edits change how much a surface reflects, not where to, which\n"
     "is as it was (kept), or each of its terms' for itself, which takes more memory and\n"
     "follows edits from diffuse to sharp (terms), or Lambertian (lambertian)"},
    OPTION_GROUP(EDIT_DIRECT),
    {.name = "direct", .type = OPTION_FLAG, .offset = AT(direct),
     .help = "direct light only, by triangles of the sky"},
    {.name = "unshadowed", .type = OPTION_FLAG, .offset = AT(unshadowed),
     .help = "nothing hides the sky, to see what shadows do"},
    {.name = "lights", .type = OPTION_INT, .offset = AT(lights), .argument = "N", .min = 8,
     .max = 1000000, .def = "4000", .help = "triangles of the sky; 400 for a preview"},
    {.name = "light-samples", .type = OPTION_INT, .offset = AT(light_samples), .argument = "N",
     .min = 2, .max = 65536, .def = "8",
     .help = "samples of other lights, and of what is not editable, for each of --spp"},
    {.name = "packets", .type = OPTION_CHOICE, .offset = AT(packets), .argument = "NAME",
     .def = "auto", .choices = precompute_packets,
     .help = "shadow rays at once: of 16 pixels, towards 16 lights, or what a measurement says"},
    OPTION_GROUP("When to stop"),
    {.name = "spp", .type = OPTION_INT, .offset = AT(spp), .argument = "N", .min = 0, .max = 1 << 30,
     .help = "samples per pixel; 0: what the scene asks for; edit --direct:\n"
             "positions in a pixel, 0: 16",
     .def = "0"},
    {.name = "time", .type = OPTION_SECONDS, .offset = AT(seconds), .argument = "SECONDS", .min = 0,
     .max = 1e9, .help = "edit: stop after so long: 90, 90s, 15m, 2h"},
    {.name = "noise", .type = OPTION_NUMBER, .offset = AT(noise), .argument = "X", .min = 0,
     .max = 1e6, .def = "0", .help = "edit: stop when the relative error of the picture as it is is no more"},
    OPTION_GROUP("To lose no work, and to share it (precompute edit)"),
    {.name = "checkpoint", .type = OPTION_SECONDS, .offset = AT(checkpoint), .argument = "SECONDS",
     .min = 0, .max = 1e9, .help = "every so often write the tensor of the samples so far, which can\n"
     "be edited already"},
    {.name = "resume", .type = OPTION_FLAG, .offset = AT(resume),
     .help = "go on from the output if it is there, also to more samples than\n"
             "before. These three, --time and --noise keep exact sums in the tensor, three\n"
             "times its size; `relume tensor requantise` drops them. --direct:\n"
             "work is kept in T.part, even when killed, and gone on with"},
    {.name = "samples", .type = OPTION_TEXT, .offset = AT(samples), .argument = "A:B",
     .help = "samples A to B-1 only, multiples of 64, for `relume tensor merge`;\n"
             "--direct: triangles in the order in which the sky is split: 0:400,\n"
             "then 400:4000, which refines it"},
    OPTION_GROUP("In place of what the scene says"),
    OPTION_SIZE(struct precompute_values, size),
    OPTION_CROP(struct precompute_values, crop),
    OPTION_RECEIVER(struct precompute_values, receiver),
    OPTION_INTEGRATOR(struct precompute_values, integrator),
    OPTION_SAMPLER(struct precompute_values, sampler),
    OPTION_MAX_DEPTH(struct precompute_values, max_depth),
    OPTION_SEED(struct precompute_values, seed),
    OPTION_DEFINE(struct precompute_values, defines),
    OPTION_LENIENT(struct precompute_values, lenient),
    OPTION_GROUP("Storage"),
    {.name = "half", .type = OPTION_FLAG, .offset = AT(half),
     .help = "store 16 bits (bfloat16) a coefficient"},
    {.name = "memory", .type = OPTION_NUMBER, .offset = AT(memory), .argument = "GB", .min = 0,
     .max = 1e6, .def = "0", .help = "most memory for sums; 0: half of what there is"},
    {.name = "dry-run", .type = OPTION_FLAG, .offset = AT(dry_run),
     .help = "only say how many bytes and hours it would take"},
    OPTION_GROUP("Running"),
    OPTION_THREADS(struct precompute_values, threads),
    OPTION_QUIET(struct precompute_values, quiet),
    OPTION_JSON(struct precompute_values, json),
    OPTION_END,
};

static void show_progress(void *user, double done) {
    progress_update(user, done, "");
}

static void report(const struct precompute_values *v, const struct relight_report *r) {
    char time[32];
    progress_format_seconds(r->seconds, time, sizeof time);
    if (r->rejected)
        log_warn("%llu samples were not finite and count as black", (unsigned long long)r->rejected);
    if (!v->quiet)
        log_info("%s: %u coefficients a pixel, %.1f MB, %llu samples per pixel %s %s (%.1f MB of sums)",
                 v->output, r->coefficients, (double)r->file_bytes * 1e-6,
                 (unsigned long long)r->samples, v->dry_run ? "would take" : "took", time,
                 (double)r->sums_bytes * 1e-6);
    if (v->json) {
        struct json *j = json_new_object();
        json_add_text(j, "output", v->output);
        json_add_bool(j, "dry_run", v->dry_run);
        json_add_count(j, "coefficients", r->coefficients);
        json_add_count(j, "file_bytes", (int64_t)r->file_bytes);
        json_add_count(j, "sums_bytes", (int64_t)r->sums_bytes);
        json_add_count(j, "samples", (int64_t)r->samples);
        json_add_count(j, "paths", (int64_t)r->paths);
        json_add_count(j, "rays", (int64_t)r->rays);
        json_add_count(j, "rejected_samples", (int64_t)r->rejected);
        json_add_number(j, "seconds", r->seconds);
        json_print(j, false);
        json_destroy(j);
    }
}

struct job_options precompute_job(const struct precompute_values *v,
                                  const struct scene_define *defines) {
    return (struct job_options){
        .scene = v->scene, .light = v->light, .spp = v->spp, .receiver = v->receiver,
        .crop = {v->crop[0], v->crop[1], v->crop[2], v->crop[3]}, .max_depth = v->max_depth,
        .seed = (uint32_t)v->seed, .threads = v->threads,
        .stop = stop_on_signals(),
        .reading = {.defines = defines, .define_count = v->defines.count, .lenient = v->lenient,
                    .integrator = v->integrator, .sampler = v->sampler, .width = v->size[0],
                    .height = v->size[1]}};
}

static int run_relight(const struct precompute_values *v, const char *command,
                       const struct scene_define *defines) {
    struct progress progress;
    struct relight_report result;
    progress_begin(&progress, "precompute", v->quiet);
    const struct relight_options o = {
        .job = precompute_job(v, defines), .basis = v->basis, .output = v->output,
        .storage = v->half ? TENSOR_BF16 : TENSOR_F32,
        .most_memory = v->memory * 1e9, .dry_run = v->dry_run, .command = command,
        .version = RELUME_VERSION, .progress = v->quiet || v->dry_run ? NULL : show_progress,
        .user = &progress};
    const bool done = precompute_relight(&o, &result);
    progress_end(&progress);
    if (done)
        report(v, &result);
    return done ? EXIT_DONE : EXIT_FAILED;
}

// Only tensors with all bounces are made by several processes.
static bool ranks_fit(const struct precompute_values *v, bool edit) {
    if (ranks_count() == 1 || (edit && !v->direct))
        return true;
    if (ranks_index() == 0)
        log_error("precompute %s%s: expected one process, found %d", v->kind,
                  v->direct ? " --direct" : "", ranks_count());
    return false;
}

// Whether all that was asked for has an effect on the kind of tensor.
static bool options_fit(const struct precompute_values *v, bool edit) {
    const struct {
        const char *heading;
        bool fits;
    } kinds[] = {{RELIGHT, !edit}, {EDIT, edit}, {EDIT_BOUNCES, edit && !v->direct},
                 {EDIT_DIRECT, edit && v->direct}};
    const char *wrong = NULL;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        wrong = kinds[i].fits ? NULL : options_changed(&subcommand_precompute.options,
                                                       kinds[i].heading, v);
        if (wrong) {
            log_error("--%s has no effect on precompute %s%s, only on %s", wrong, v->kind,
                      edit && v->direct ? " --direct" : "", kinds[i].heading);
            return false;
        }
    }
    wrong = !v->direct ? NULL : v->integrator ? "integrator" : v->max_depth ? "max-depth" : NULL;
    if (wrong) {
        log_error("--%s has no effect on precompute edit --direct, which is direct light only", wrong);
        return false;
    }
    if (edit && v->integrator && strcmp(v->integrator, "path") != 0) {
        log_error("--integrator %s has no effect on precompute edit, which follows paths as path does",
                  v->integrator);
        return false;
    }
    return true;
}

static int run(const void *values, const char *command) {
    const struct precompute_values *v = values;
    const bool edit = strcmp(v->kind, "edit") == 0;
    if (!edit && strcmp(v->kind, "relight") != 0) {
        log_error("precompute %s: expected relight or edit", v->kind);
        return EXIT_USAGE;
    }
    if (!options_fit(v, edit))
        return EXIT_USAGE;
    const bool by_and_by = v->seconds > 0 || v->noise > 0 || v->checkpoint > 0;
    if (precompute_is_progressive(v) && (!edit || (v->direct && by_and_by))) {
        log_error("--samples, --time, --noise, --checkpoint and --resume go with edit, and without "
                  "--direct all of them");
        return EXIT_USAGE;
    }
    double relmse = 0;
    if (v->budget && (v->half || v->samples || v->checkpoint > 0 || v->resume)) {
        log_error("--budget goes without --half and where nothing is to be gone on with (--samples, "
                  "--checkpoint, --resume keep sums); store those by `relume tensor requantise --budget`");
        return EXIT_USAGE;
    }
    if (v->budget && !budget_parse(v->budget, &relmse))
        return EXIT_USAGE;
    if (v->quiet)
        log_set_level(LOG_WARN);
    struct arena arena = {0};
    const struct scene_define *defines = defines_parse(&v->defines, &arena);
    ranks_start();
    if (ranks_index() > 0)
        log_set_level(LOG_ERROR); // rank 0 says it once
    int code = !defines || !ranks_fit(v, edit) ? EXIT_USAGE
               : edit                          ? precompute_edit_run(v, command, defines)
                                               : run_relight(v, command, defines);
    ranks_finish();
    arena_finish(&arena);
    // What --time or --noise has ended is whole; what a signal has ended keeps its sums.
    const bool whole = code == EXIT_DONE || (code == EXIT_UNCONVERGED && !*stop_on_signals());
    if (whole && v->budget && ranks_index() == 0 && !v->dry_run && !budget_run(&(struct budget_run){
            .tensor = v->output, .output = v->output, .command = command, .relmse = relmse,
            .threads = v->threads, .quiet = v->quiet, .json = v->json}))
        code = EXIT_FAILED;
    return code;
}

const struct subcommand subcommand_precompute = {
    .entry = {.name = "precompute", .help = "make a tensor, from which pictures are replayed",
              .size = sizeof(struct precompute_values)},
    .options = {.options = options, .arguments = arguments,
                .description = "precompute relight: how the picture of SCENE depends on its "
                               "lighting, with all bounces.\n`relume relight` then makes pictures "
                               "under other lighting at the speed of memory.\nprecompute edit: how "
                               "it depends on its editable materials, with all bounces or, --direct, "
                               "under direct light;\n`relume edit` changes them. What the eye sees "
                               "keeps its curves; where light was before, edits change how much\n"
                               "surfaces reflect (--later), unless --series leaves the second hop a coarser curve.",
                .examples = "  relume precompute relight room.xml -o room.safetensors --basis lights "
                            "--spp 256\n"
                            "  relume precompute relight car.xml -o car.safetensors --basis "
                            "pixels:32x16 --dry-run\n"
                            "  relume precompute edit room.xml -o sun.safetensors --direct --edit "
                            "floor --lights 400\n"
                            "  relume precompute edit room.xml -o floor.safetensors --edit floor "
                            "--series 64,8 --bounces 3\n"},
    .run = run,
};
