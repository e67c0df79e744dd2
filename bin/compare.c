// SPDX-License-Identifier: Apache-2.0
#include "base/log.h"
#include "image/comparison.h"
#include "image/comparison_report.h"
#include "subcommand.h"

struct compare_options {
    struct comparison_request request;
    int map;
    struct option_list limits;
    bool json;
};

#define WITH_ZTEST "With --ztest"
#define WITH_MAP "With --map"

// Whether no option needs another one that is not there.
static bool options_fit(const struct compare_options *o) {
    const struct option_table *table = &subcommand_compare.options;
    const char *test = o->request.variance ? NULL : options_changed(table, WITH_ZTEST, o);
    const char *map = o->request.map_path ? NULL : options_changed(table, WITH_MAP, o);
    if (test)
        log_error("compare: --%s goes with --ztest", test);
    else if (map)
        log_error("compare: --%s goes with --map", map);
    return !test && !map;
}

// What is not finite was left out of the metrics: with it no limit is known to hold.
static bool limits_hold(const struct compare_options *o, const struct comparison *c) {
    bool hold = true, exceeded;
    for (size_t i = 0; i < o->limits.count; i++) {
        comparison_check_limit(o->limits.items[i], c, &exceeded);
        if (exceeded)
            log_error("%s: exceeds the limit %s", o->request.test, o->limits.items[i]);
        hold = hold && !exceeded;
    }
    if (o->limits.count == 0 || c->metrics.left_out == 0)
        return hold;
    log_error("%s: no limit of --fail-above holds where values of it or of %s are not finite",
              o->request.test, o->request.ref);
    return false;
}

static int run(const void *values, const char *command) {
    const struct compare_options *o = values;
    struct comparison_request request = o->request;
    struct comparison c = {0};
    bool exceeded;
    (void)command;
    if (!options_fit(o))
        return EXIT_USAGE;
    for (size_t i = 0; i < o->limits.count; i++) // their form, before the work
        if (!comparison_check_limit(o->limits.items[i], &c, &exceeded))
            return EXIT_USAGE;
    request.map = (enum comparison_map)o->map;
    if (!comparison_run(&request, &c))
        return EXIT_FAILED;
    if (o->json)
        comparison_print_json(&c);
    else
        comparison_print(&c);
    const bool passed = !c.tested || c.ztest.pass;
    return limits_hold(o, &c) && passed ? EXIT_DONE : EXIT_FAILED;
}

#define AT(member) offsetof(struct compare_options, member)
static const struct option_spec options[] = {
    {.name = "ztest", .type = OPTION_TEXT, .offset = AT(request.variance), .argument = "VAR.exr",
     .help = "also test whether the pictures agree within their noise, by pixels,\n"
             "8x8 blocks and means; exit 1 if not. VAR: the variance of REF's single-\n"
             "sample estimates, as Mitsuba's ..._var.exr, or a picture of the scene\n"
             "with a layer `variance`. With the latter REF and TEST that have such a\n"
             "layer both count with their own errors; else VAR's is multiplied by its\n"
             "samples and divided by those of TEST and REF, which holds for\n"
             "--sampler independent. Light that no sample of a pixel has met is in no\n"
             "error: where few, rare samples bring much, more values disagree than\n"
             "the share printed as that of noise alone says"},
    {.name = "map", .type = OPTION_TEXT, .offset = AT(request.map_path), .argument = "OUT.png",
     .help = "write a picture of the difference", .endings = ".png"},
    {.name = "fail-above", .type = OPTION_TEXTS, .offset = AT(limits), .argument = "METRIC=X",
     .help = "exit 1 if METRIC is above X: mean (|ratio - 1|), mse, relmse, flip,\n"
             "ldr-flip, ssim (1 - SSIM), psnr (-PSNR); also if any value of REF or\n"
             "TEST is not finite"},
    {.name = "eps", .type = OPTION_NUMBER, .offset = AT(request.eps), .argument = "E",
     .help = "relMSE divides by ref^2 + E; -1: 1e-3 of the squared mean of REF", .def = "-1",
     .min = -1, .max = 1e30},
    {.name = "exposure", .type = OPTION_NUMBER, .offset = AT(request.exposure),
     .argument = "STOPS", .help = "exposure at which PSNR, SSIM and LDR-FLIP look", .def = "0",
     .min = -60, .max = 60},
    {.name = "ppd", .type = OPTION_NUMBER, .offset = AT(request.pixels_per_degree),
     .argument = "N", .help = "pixels per degree of the viewer of FLIP", .def = "67.0206432765823",
     .min = 1, .max = 3700},
    {.name = "downsample", .type = OPTION_INT, .offset = AT(request.downsample), .argument = "N",
     .help = "first average NxN boxes: of the larger picture, or of both if equal", .def = "1",
     .min = 1, .max = 4096},
    OPTION_GROUP(WITH_ZTEST),
    {.name = "samples", .type = OPTION_NUMBER, .offset = AT(request.samples), .argument = "N",
     .help = "TEST's samples per pixel; 0: what the file says", .def = "0", .min = 0,
     .max = 1e15},
    {.name = "ref-samples", .type = OPTION_NUMBER, .offset = AT(request.ref_samples),
     .argument = "N",
     .help = "REF's samples per pixel; 0: what the file says, and if it does not,\n"
             "32000 (Mitsuba's references), of which pixels then disregard the noise",
     .def = "0", .min = 0, .max = 1e15},
    OPTION_GROUP(WITH_MAP),
    {.name = "map-kind", .type = OPTION_CHOICE, .offset = AT(map), .argument = "KIND",
     .help = "HDR-FLIP in magma, or (test-ref)/ref with red above and blue\n"
             "below", .def = "flip",
     .choices = comparison_map_names},
    OPTION_GROUP("Running"),
    OPTION_THREADS(struct compare_options, request.threads),
    OPTION_JSON(struct compare_options, json),
    OPTION_END,
};

static const struct option_argument arguments[] = {
    {.name = "REF", .offset = AT(request.ref), .help = "the picture that is taken as true"},
    {.name = "TEST", .offset = AT(request.test), .help = "the picture to measure"},
    {.name = NULL},
};

const struct subcommand subcommand_compare = {
    .entry = {.name = "compare", .help = "measure how far a picture is from its reference",
              .size = sizeof(struct compare_options)},
    .options =
        {.options = options,
         .arguments = arguments,
         .description = "Where a file has a layer `variance` (render --variance), each value comes "
                        "with the 95 %\nconfidence interval that this noise leaves it, if it can "
                        "be told: not from one\nsample per pixel. A crop is compared with its "
                        "part of REF.",
         .examples = "  relume compare ref.exr out.exr --map difference.png\n"
                     "  relume compare ref.exr out.exr --ztest ref.exr\n"
                     "  relume compare ref.exr out.exr --ztest ref_var.exr --samples 868\n"
                     "  relume compare big.exr out.exr --downsample 2 --fail-above relmse=0.001\n"},
    .run = run,
};
