// SPDX-License-Identifier: Apache-2.0
// relume tonemap: a picture to look at.
#include <stdio.h>

#include "base/log.h"
#include "image/false_colour.h"
#include "image/tonemap.h"
#include "subcommand.h"

struct tonemap_options {
    const char *in, *out, *layer;
    double exposure, efficacy;
    const char *range;
    int curve, quantity;
    bool linear;
};

enum quantity { QUANTITY_NONE, QUANTITY_PLAIN, QUANTITY_LUMINANCE, QUANTITY_LUX };
static const char *const quantities[] = {"none", "plain", "cd/m2", "lux", NULL};

// The picture as colours of a scale.
static bool map_quantity(const struct tonemap_options *o, struct image *rgb) {
    const bool plain = o->quantity == QUANTITY_PLAIN;
    struct false_colour f = {.factor = plain ? 1 : o->efficacy, .linear = o->linear,
                             .unit = plain ? "" : quantities[o->quantity]};
    struct image mapped = {0};
    char rest;
    if (o->range && (sscanf(o->range, "%lf:%lf%c", &f.low, &f.high, &rest) != 2 ||
                     !(f.low < f.high && f.high < 1e30 && f.low > (f.linear ? -1e30 : 0)))) {
        log_error("--range %s: expected LOW:HIGH, %s", o->range,
                  f.linear ? "LOW below HIGH" : "both above 0 and LOW below HIGH");
        return false;
    }
    const bool good = false_colour_map(rgb, &f, &mapped);
    image_finish(rgb);
    *rgb = mapped;
    return good;
}

static int run(const void *values, const char *command) {
    const struct tonemap_options *o = values;
    struct image im = {0}, rgb = {0};
    (void)command;
    bool good = image_read(o->in, &im) && image_layer_to_rgb(&im, o->layer, o->in, &rgb);
    if (good && o->quantity == QUANTITY_NONE)
        tone_map(&rgb, o->exposure, (enum tone_curve)o->curve);
    else if (good)
        good = map_quantity(o, &rgb);
    good = good && image_write_png(o->out, &rgb);
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
    {.name = "false-colour", .letter = 'f', .type = OPTION_CHOICE, .offset = AT(quantity),
     .argument = "UNIT", .help = "luminance as colours, with a legend: plain as the picture has it,\n"
     "cd/m2 or lux times --efficacy (lux of a picture of irradiance)", .def = "none",
     .choices = quantities},
    {.name = "efficacy", .type = OPTION_NUMBER, .offset = AT(efficacy), .argument = "LM_PER_W",
     .min = 1e-6, .max = 1e6, .def = "683",
     .help = "lumens for a watt of luminance; Radiance takes 179"},
    {.name = "range", .type = OPTION_TEXT, .offset = AT(range), .argument = "LOW:HIGH",
     .help = "ends of the scale of --false-colour; else those of the picture"},
    {.name = "linear", .type = OPTION_FLAG, .offset = AT(linear),
     .help = "a linear scale for --false-colour; else it is logarithmic"},
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
                            "  relume tonemap room.exr -o albedo.png --layer albedo\n"
                            "  relume tonemap room.exr -o room.png --false-colour cd/m2 --range "
                            "1:1000\n"},
    .run = run,
};
