// SPDX-License-Identifier: Apache-2.0
#include "image/tonemap.h"
#include "subcommand.h"

struct tonemap_options {
    const char *in, *out, *layer;
    double exposure;
    int curve;
};

static int run(const void *values, const char *command) {
    const struct tonemap_options *o = values;
    struct image im = {0}, rgb = {0};
    (void)command;
    bool good = image_read(o->in, &im) && image_layer_to_rgb(&im, o->layer, o->in, &rgb);
    if (good) {
        tone_map(&rgb, o->exposure, (enum tone_curve)o->curve);
        good = image_write_png(o->out, &rgb);
    }
    image_finish(&im);
    image_finish(&rgb);
    return good ? EXIT_DONE : EXIT_FAILED;
}

#define AT(member) offsetof(struct tonemap_options, member)
static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(out), .argument = "OUT.png",
     .help = "the picture to write, 8-bit sRGB", .required = true},
    {.name = "exposure", .letter = 'e', .type = OPTION_NUMBER, .offset = AT(exposure),
     .argument = "STOPS", .help = "multiplies radiance by 2^STOPS first", .def = "0", .min = -60,
     .max = 60},
    {.name = "curve", .letter = 'c', .type = OPTION_CHOICE, .offset = AT(curve),
     .argument = "NAME", .help = "srgb clips at 1, filmic is the ACES fit of Narkowicz 2015",
     .def = "srgb", .choices = tone_curve_names},
    {.name = "layer", .letter = 'l', .type = OPTION_TEXT, .offset = AT(layer), .argument = "NAME",
     .help = "a layer such as albedo, or a channel such as Z; empty: the picture itself",
     .def = ""},
    OPTION_END,
};

static const struct option_argument arguments[] = {
    {.name = "IN", .offset = AT(in), .help = "an EXR or any other picture"},
    {.name = NULL},
};

const struct subcommand subcommand_tonemap = {
    .entry = {.name = "tonemap", .help = "turn a radiance picture into a PNG to look at",
              .size = sizeof(struct tonemap_options)},
    .options = {.options = options,
                .arguments = arguments,
                .examples = "  relume tonemap room.exr -o room.png --exposure 1.5 --curve filmic\n"
                            "  relume tonemap room.exr -o albedo.png --layer albedo\n"},
    .run = run,
};
