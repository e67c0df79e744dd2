// SPDX-License-Identifier: Apache-2.0
// relume verify: the error of an edited picture, by path tracing some of its pixels.
#include "driver/verify.h"

#include <math.h>

#include "base/log.h"
#include "base/progress.h"
#include "driver/stop.h"
#include "scene_options.h"
#include "subcommand.h"

struct values {
    const char *tensor, *scene, *edits;
    int pixels, spp, seed, threads;
    bool all_bounces, no_device, lenient, quiet, json;
    struct option_list defines;
};

#define AT(member) offsetof(struct values, member)

static const struct option_argument arguments[] = {
    {"T", AT(tensor), "tensor of `relume precompute edit`", false, false},
    {"SCENE", AT(scene), "the scene it was made of", false, false},
    {"EDITS.json", AT(edits), "a session of `relume edit`, whose changes are made", true, false},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "pixels", .type = OPTION_INT, .offset = AT(pixels), .argument = "N", .min = 16,
     .max = 1 << 28, .def = "1024", .help = "how many to trace, in random blocks of 4x4; fewer than 2048 are spread\n"
             "over as many, with fewer samples each"},
    {.name = "spp", .type = OPTION_INT, .offset = AT(spp), .argument = "N", .min = 1, .max = 1 << 30,
     .def = "256", .help = "samples per pixel of each of the two traces"},
    {.name = "all-bounces", .type = OPTION_FLAG, .offset = AT(all_bounces),
     .help = "the truth has all bounces, not as many as the tensor"},
    {.name = "seed", .type = OPTION_INT, .offset = AT(seed), .argument = "N", .min = 0,
     .max = 1000000000, .def = "0", .help = "other pixels, other noise"},
    OPTION_DEFINE(struct values, defines),
    OPTION_LENIENT(struct values, lenient),
    {.name = "no-device", .type = OPTION_FLAG, .offset = AT(no_device), .help = "do without OpenCL"},
    OPTION_THREADS(struct values, threads),
    OPTION_QUIET(struct values, quiet),
    OPTION_JSON(struct values, json),
    OPTION_END,
};

static void show_progress(void *user, double done, const struct film *film) {
    (void)film;
    progress_update(user, done, "");
}

static void report(const struct values *v, const struct verify_result *r) {
    if (!v->quiet)
        log_info("relMSE %.3g +- %.2g (95 %%, %u pixels in %u blocks); the tensor's noise is %.2g of "
                 "it, and the picture is %.2f %% too %s", r->relmse, r->relmse_error, r->pixels,
                 r->blocks, r->noise, fabs(r->bias * 100), r->bias < 0 ? "dark" : "bright");
    if (v->json) {
        struct json *j = json_new_object();
        json_add_count(j, "pixels", r->pixels);
        json_add_count(j, "blocks", r->blocks);
        json_add_count(j, "bounces", r->bounces);
        json_add_number(j, "relmse", r->relmse);
        json_add_number(j, "relmse_95", r->relmse_error);
        json_add_number(j, "noise", r->noise);
        json_add_number(j, "bias", r->bias);
        json_add_number(j, "mean", r->mean);
        json_add_number(j, "seconds", r->seconds);
        json_print(j, false);
        json_destroy(j);
    }
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    struct arena arena = {0};
    struct progress progress;
    struct verify_result result;
    const struct scene_define *defines = defines_parse(&v->defines, &arena);
    (void)command;
    if (v->quiet)
        log_set_level(LOG_WARN);
    progress_begin(&progress, "verify", v->quiet);
    const struct verify_options o = {
        .job = {.scene = v->scene, .spp = v->spp, .seed = (uint32_t)v->seed, .threads = v->threads,
                .stop = stop_on_signals(), .progress = v->quiet ? NULL : show_progress,
                .user = &progress,
                .reading = {.defines = defines, .define_count = v->defines.count,
                            .lenient = v->lenient}},
        .tensor = v->tensor, .edits = v->edits, .pixels = (uint32_t)v->pixels,
        .all_bounces = v->all_bounces, .no_device = v->no_device};
    const bool done = defines && verify_edit(&o, &result);
    progress_end(&progress);
    if (done)
        report(v, &result);
    arena_finish(&arena);
    return done ? EXIT_DONE : defines ? EXIT_FAILED : EXIT_USAGE;
}

const struct subcommand subcommand_verify = {
    .entry = {.name = "verify", .help = "tell the error of an edited picture by path tracing",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description = "Path-traces random pixels of the edited scene twice, independently: "
                               "the mean of the product\nof the picture's distances from both is its "
                               "squared error, all causes together, without\nthe noise of the traces."},
    .run = run,
};
