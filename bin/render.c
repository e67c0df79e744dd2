// SPDX-License-Identifier: Apache-2.0
// relume render: a picture from a scene file.
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "base/progress.h"
#include "driver/checkpoint.h"
#include "driver/ranks.h"
#include "driver/stop.h"
#include "render_report.h"
#include "scene_options.h"
#include "subcommand.h"

struct values {
    struct receiver receiver;
    const char *scene, *output, *integrator, *sampler, *aovs;
    int spp, size[2], crop[4], max_depth, seed, threads;
    double seconds, noise, checkpoint, preview, clamp;
    int space;
    const char *samples, *cryptomatte;
    bool variance, light_groups, paths, half, lenient, quiet, json, resume, adaptive, may_leak;
    struct option_list defines;
};

static const struct option_argument arguments[] = {
    {"SCENE", offsetof(struct values, scene), "scene (.xml, .pbrt) or model (.gltf, .glb, .obj)", false, false},
    {.name = NULL},
};

#define AT(member) offsetof(struct values, member)

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(output), .argument = "OUT.exr",
     .help = "the picture to write; relume tonemap makes other pictures of it", .endings = ".exr",
     .required = true},
    OPTION_GROUP("When to stop"),
    {.name = "spp", .type = OPTION_INT, .offset = AT(spp), .argument = "N", .min = 0, .max = 1 << 30,
     .help = "stop after N samples per pixel; 0: what the scene asks for", .def = "0"},
    {.name = "time", .type = OPTION_SECONDS, .offset = AT(seconds), .argument = "SECONDS", .min = 0,
     .max = 1e9, .help = "stop after so long: 90, 90s, 15m, 2h"},
    {.name = "noise", .type = OPTION_NUMBER, .offset = AT(noise), .argument = "X", .min = 0,
     .max = 1e3,
     .help = "stop when the relative standard error of the pixels (root mean square)\n"
             "is no more than X; looked at every 64 samples. Implies --variance"},
    {.name = "adaptive", .type = OPTION_FLAG, .offset = AT(adaptive),
     .help = "take more samples where a pilot of 16 finds noise, fewer elsewhere, the\n"
             "same number in all; without bias. Layer `samples` says where"},
    OPTION_GROUP("To lose no work, and to share it"),
    {.name = "checkpoint", .type = OPTION_SECONDS, .offset = AT(checkpoint), .argument = "SECONDS",
     .min = 0, .max = 1e9,
     .help = "every so often write what is done to OUT.exr.journal"},
    {.name = "resume", .type = OPTION_FLAG, .offset = AT(resume),
     .help = "go on from OUT.exr.journal if it is there, also to more samples than\n"
             "before; keeps the journal"},
    {.name = "preview", .type = OPTION_SECONDS, .offset = AT(preview), .argument = "SECONDS",
     .min = 0, .max = 1e9, .help = "every so often write the picture so far"},
    {.name = "samples", .type = OPTION_TEXT, .offset = AT(samples), .argument = "A:B",
     .help = "render samples A to B-1 only, multiples of 64, for `relume merge`;\n"
             "keeps a journal"},
    OPTION_GROUP("In place of what the scene says"),
    OPTION_SIZE(struct values, size),
    OPTION_CROP(struct values, crop),
    OPTION_RECEIVER(struct values, receiver),
    OPTION_INTEGRATOR(struct values, integrator),
    OPTION_SAMPLER(struct values, sampler),
    OPTION_MAX_DEPTH(struct values, max_depth),
    OPTION_SEED(struct values, seed),
    {.name = "clamp", .type = OPTION_NUMBER, .offset = AT(clamp), .argument = "X", .min = 0,
     .max = 1e30, .def = "0",
     .help = "most that one piece of indirect light may bring to a sample, as the mean of\n"
             "R, G and B; 0: no limit. Cuts off fireflies and with them light: how much\n"
             "is always said, and layer `clamped` shows where"},
    {.name = "may-leak", .type = OPTION_FLAG, .offset = AT(may_leak),
     .help = "let rays slip through where triangles of large scenes share an edge (6 of 1e8\n"
             "leave a globe of 2300): 0.85 to 0.95 of the time. Mitsuba's default, not ours; in\n"
             "a file, `embree_use_robust_intersections` false"},
    OPTION_DEFINE(struct values, defines),
    OPTION_LENIENT(struct values, lenient),
    OPTION_GROUP("Layers"),
    {.name = "aov", .type = OPTION_TEXT, .offset = AT(aovs), .argument = "LIST",
     .help = "layers of what is seen first: albedo,N,Ng,Z,P,uv,shape,instance"},
    {.name = "cryptomatte", .type = OPTION_TEXT, .offset = AT(cryptomatte), .argument = "LIST",
     .help = "masks by name: object,material (Cryptomatte 1.2), from the picture's first\n"
             "256 samples"},
    {.name = "variance", .type = OPTION_FLAG, .offset = AT(variance),
     .help = "write the squared standard error of each pixel as layer `variance`; one\n"
             "sample per pixel does not tell it"},
    {.name = "light-groups", .type = OPTION_FLAG, .offset = AT(light_groups),
     .help = "write a layer per emitter, or per `group` name"},
    {.name = "paths", .type = OPTION_FLAG, .offset = AT(paths),
     .help = "write direct/indirect x diffuse/glossy/specular layers"},
    OPTION_GROUP("The file"),
    {.name = "colour-space", .type = OPTION_CHOICE, .offset = AT(space), .argument = "NAME",
     .help = "primaries of the picture", .def = "rec709",
     .choices = image_space_names},
    {.name = "half", .type = OPTION_FLAG, .offset = AT(half), .help = "write 16-bit channels, but for numbers that name objects"},
    OPTION_GROUP("Running"),
    OPTION_THREADS(struct values, threads),
    OPTION_QUIET(struct values, quiet),
    OPTION_JSON(struct values, json),
    OPTION_END,
};

struct listener {
    struct progress progress;
    struct checkpoint checkpoint;
    bool quiet;
};

static void between_passes(void *user, double done, const struct film *film) {
    struct listener *l = user;
    char note[64] = "";
    checkpoint_tick(&l->checkpoint, film);
    if (l->quiet || !progress_is_due(&l->progress))
        return;
    const double noise = film_noise(film);
    if (noise >= 0)
        snprintf(note, sizeof note, "noise %.2f %%", 100 * noise);
    progress_update(&l->progress, done, note);
}

// Whether all ranks can go on; one that cannot has said why. Else the others would wait for it.
static bool all_can(bool can) {
    uint64_t failed = !can;
    ranks_sum(&failed, 1);
    ranks_broadcast(&failed, sizeof failed);
    return failed == 0;
}

static int trace_and_write(const struct values *v, const char *command, struct job *job,
                           struct film *film, struct listener *l) {
    struct render_outcome o = {.output = v->output};
    const struct image_exr_options exr = {.half = v->half, .half_overflows = &o.half_overflows,
                                          .overflows = &o.overflows};
    const struct checkpoint_options keeping = {
        .output = v->output, .command = command, .version = RELUME_VERSION, .seconds = v->checkpoint,
        .preview_seconds = v->preview, .resume = v->resume, .exr = &exr,
        .space = (enum image_space)v->space,
        .keep = v->checkpoint > 0 || v->resume || v->samples};
    const bool helps = ranks_index() > 0; // rank 0 keeps and reports
    bool written = all_can(helps || checkpoint_open(&l->checkpoint, &keeping, job, film));
    if (helps) {
        if (written)
            job_trace(job, film, &o.render);
        return written ? EXIT_DONE : EXIT_FAILED;
    }
    if (written) {
        job_trace(job, film, &o.render);
        progress_end(&l->progress);
        o.rejected = film_rejected(film);
        o.one_sample = (v->variance || v->noise > 0) && film_samples(film) == 1;
        o.keeping = l->checkpoint.spent;
        o.clamp = v->clamp;
        o.clamped = film_clamped(film);
        written = checkpoint_finish(&l->checkpoint, film);
        written = checkpoint_picture(&l->checkpoint, film, &o.render) && written;
    }
    checkpoint_close(&l->checkpoint);
    if (!written)
        return EXIT_FAILED;
    render_report_warnings(&o);
    if (!v->quiet)
        render_report(&o);
    if (v->json)
        render_report_json(job, &o);
    return o.render.stopped ? EXIT_UNCONVERGED : EXIT_DONE;
}

static int run_job(const struct values *v, const char *command, const struct scene_define *defines,
                   const uint64_t samples[2]) {
    char temp[4096];
    struct listener listener = {.quiet = v->quiet};
    struct job job;
    if (!file_temp_name(v->output, temp, sizeof temp)) // know now, not after an hour
        return EXIT_FAILED;
    progress_begin(&listener.progress, "render", v->quiet);
    ranks_start();
    const struct job_options job_options = {
        .scene = v->scene, .spp = v->spp, .receiver = v->receiver,
        .crop = {v->crop[0], v->crop[1], v->crop[2], v->crop[3]}, .max_depth = v->max_depth,
        .seed = (uint32_t)v->seed, .threads = v->threads, .aovs = v->aovs,
        .cryptomatte = v->cryptomatte, .variance = v->variance, .light_groups = v->light_groups,
        .paths = v->paths, .adaptive = v->adaptive, .may_leak = v->may_leak,
        .clamp = v->clamp, .samples = {samples[0], samples[1]}, .seconds = v->seconds, .noise = v->noise,
        .stop = stop_on_signals(), .progress = between_passes, .user = &listener,
        .reading = {.defines = defines, .define_count = v->defines.count, .lenient = v->lenient,
                    .integrator = v->integrator, .sampler = v->sampler, .width = v->size[0],
                    .height = v->size[1]}};
    if (ranks_index() > 0)
        log_set_level(LOG_ERROR); // rank 0 says it once
    const bool opened = job_open(&job, &job_options);
    if (!all_can(opened)) {
        if (opened)
            job_close(&job);
        ranks_finish();
        return EXIT_FAILED;
    }
    struct film *film = job_film(&job);
    const int code = trace_and_write(v, command, &job, film, &listener);
    film_destroy(film);
    job_close(&job);
    ranks_finish();
    return code;
}

// Whether a name given as an option stands for something.
static bool is_known(const struct registry *r, const char *name) {
    if (!name || registry_find(r, name))
        return true;
    const char *nearest = registry_nearest(r, name);
    log_error("--%s: found '%s'%s%s%s (see relume help %s)", r->kind, name,
              nearest ? "; the nearest is '" : "", nearest ? nearest : "", nearest ? "'" : "",
              r->kind);
    return false;
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    uint32_t aovs;
    uint64_t samples[2];
    if (!samples_parse(v->samples, samples) || !is_known(&integrators, v->integrator) ||
        !is_known(&samplers, v->sampler) || (v->aovs && !film_aovs_parse(v->aovs, &aovs)))
        return EXIT_USAGE;
    if (v->space != SPACE_REC709 && (v->variance || v->noise > 0)) {
        log_error("--colour-space %s: errors of channels (--variance, --noise) are those of rec709",
                  image_space_names[v->space]);
        return EXIT_USAGE;
    }
    if (v->quiet)
        log_set_level(LOG_WARN);
    struct arena arena = {0};
    const struct scene_define *defines = defines_parse(&v->defines, &arena);
    const int code = defines ? run_job(v, command, defines, samples) : EXIT_USAGE;
    arena_finish(&arena);
    return code;
}

static void print_registries(void) {
    printf("\nIntegrators:\n");
    registry_print(&integrators);
    printf("\nSamplers:\n");
    registry_print(&samplers);
    printf("\nrelume help explains them and all that a scene may hold; relume help integrator path,\n"
           "for instance, lists the parameters of path.\n");
}

const struct subcommand subcommand_render = {
    .entry = {.name = "render", .help = "make a picture from a scene file",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description = "Path traces SCENE. Stops at --spp, --time or --noise, whichever "
                               "comes first, or on\nCtrl-C with what is complete. Exit code 3: a "
                               "picture was written, but it was stopped\nor is noisier than "
                               "--noise.",
                .examples = "  relume render scene.xml -o out.exr --spp 256\n"
                            "  relume render scene.xml -o out.exr --size 640x360 --aov albedo,N,Z "
                            "--variance\n"
                            "  relume render scene.xml -o lights.exr --light-groups\n"
                            "  relume render scene.xml -o ref.exr --noise 0.01 --checkpoint 60 "
                            "--resume\n",
                .more_help = print_registries},
    .run = run,
};
