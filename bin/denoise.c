// SPDX-License-Identifier: Apache-2.0
// relume denoise: a picture without noise, and without a promise.
#include "base/log.h"
#include "image/denoise.h"
#include "subcommand.h"

struct values {
    const char *in, *out;
    struct denoise_options denoise;
    bool quiet;
};

#define AT(member) offsetof(struct values, member)

static const struct option_argument arguments[] = {
    {.name = "IN.exr", .offset = AT(in), .help = "a picture; layers albedo and N help much"},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(out), .argument = "OUT.exr",
     .help = "the picture to write, with all layers but `variance`", .endings = ".exr",
     .required = true},
    {.name = "colour-only", .type = OPTION_FLAG, .offset = AT(denoise.colour_only),
     .help = "leave albedo and normals aside"},
    OPTION_THREADS(struct values, denoise.threads),
    OPTION_QUIET(struct values, quiet),
    OPTION_END,
};

static int run(const void *values, const char *command) {
    const struct values *v = values;
    struct image im = {0};
    if (v->quiet)
        log_set_level(LOG_WARN);
    bool good = image_read(v->in, &im) && denoise(&im, &v->denoise);
    if (good) {
        image_set_text(&im, "relume.command", command);
        good = image_write_exr(v->out, &im, NULL);
    }
    if (good && !v->quiet)
        log_info("%s: %s", v->out, image_find_attribute(&im, "relume.denoised")->text);
    image_finish(&im);
    return good ? EXIT_DONE : EXIT_FAILED;
}

const struct subcommand subcommand_denoise = {
    .entry = {.name = "denoise", .help = "take the noise out of a picture (Open Image Denoise)",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description = "Runs Open Image Denoise where that is installed. The picture is then "
                               "biased, and says so in its\nattribute relume.denoised; measure what "
                               "it lost with `relume compare`.",
                .examples = "  relume render room.xml -o noisy.exr --spp 16 --aov albedo,N\n"
                            "  relume denoise noisy.exr -o smooth.exr\n"},
    .run = run,
};
