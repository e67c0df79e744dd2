// SPDX-License-Identifier: Apache-2.0
// relume tonemap: a picture to look at.
#include <math.h>
#include <stdio.h>

#include "base/log.h"
#include "image/display.h"
#include "image/false_colour.h"
#include "image/tonemap.h"
#include "subcommand.h"

struct tonemap_options {
    const char *in, *out, *layer;
    double exposure, efficacy;
    const char *range, *config, *display, *view, *from;
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

static void expose(struct image *rgb, double stops) {
    const size_t n = (size_t)rgb->width * (size_t)rgb->height * (size_t)rgb->channels;
    const float gain = (float)exp2(stops);
    for (size_t i = 0; i < n; i++)
        rgb->pixels[i] *= gain;
}

static bool has_view(const struct tonemap_options *o) {
    return o->config || o->display || o->view || o->from;
}

static bool agrees(const struct tonemap_options *o) {
    const bool numbers = o->quantity != QUANTITY_NONE, curve = o->curve != TONE_SRGB;
    const char *what = NULL;
    if (has_view(o) && (numbers || curve))
        what = "a view of OpenColorIO is a curve of its own: expected no --curve and no "
               "--false-colour beside it";
    else if (numbers && (curve || o->exposure != 0))
        what = "--false-colour shows numbers: expected no --curve and no --exposure beside it";
    else if (!numbers && (o->range || o->linear))
        what = "--range and --linear are of a scale: expected --false-colour beside them";
    if (what)
        log_error("%s", what);
    return !what;
}

static bool map(const struct tonemap_options *o, struct image *rgb) {
    if (o->quantity != QUANTITY_NONE)
        return map_quantity(o, rgb);
    if (!has_view(o)) {
        tone_map(rgb, o->exposure, (enum tone_curve)o->curve);
        return true;
    }
    expose(rgb, o->exposure);
    return image_display(o->config, o->display, o->view, o->from, rgb);
}

static int run(const void *values, const char *command) {
    const struct tonemap_options *o = values;
    struct image im = {0}, rgb = {0};
    (void)command;
    if (!agrees(o))
        return EXIT_USAGE;
    bool good = image_read(o->in, &im) && image_layer_to_rgb(&im, o->layer, o->in, &rgb);
    good = good && map(o, &rgb);
    good = good && image_write_png(o->out, &rgb);
    image_finish(&im);
    image_finish(&rgb);
    return good ? EXIT_DONE : EXIT_FAILED;
}

#define AT(member) offsetof(struct tonemap_options, member)
static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(out), .argument = "OUT.png",
     .help = "the picture to write, 8-bit sRGB", .endings = ".png", .required = true},
    {.name = "exposure", .letter = 'e', .type = OPTION_NUMBER, .offset = AT(exposure),
     .argument = "STOPS", .help = "multiplies radiance by 2^STOPS first", .def = "0", .min = -60,
     .max = 60},
    {.name = "curve", .letter = 'c', .type = OPTION_CHOICE, .offset = AT(curve),
     .argument = "NAME", .help = "srgb clips at 1, filmic is the ACES fit of Narkowicz 2015",
     .def = "srgb", .choices = tone_curve_names},
    {.name = "ocio", .type = OPTION_TEXT, .offset = AT(config), .argument = "CONFIG",
     .help = "show a view of this OpenColorIO configuration; else of the variable OCIO\n"
             "where --view or --display is given"},
    {.name = "display", .type = OPTION_TEXT, .offset = AT(display), .argument = "NAME",
     .help = "display of the configuration; else its default"},
    {.name = "view", .type = OPTION_TEXT, .offset = AT(view), .argument = "NAME",
     .help = "view of the display; else its default"},
    {.name = "from", .type = OPTION_TEXT, .offset = AT(from), .argument = "SPACE",
     .help = "the configuration's colour space or role of linear Rec.709, where it is\n"
             "found neither by name nor by the role aces_interchange"},
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
                            "  relume tonemap room.exr -o room.png --ocio config.ocio --view "
                            "Filmic\n"
                            "  relume tonemap room.exr -o albedo.png --layer albedo\n"
                            "  relume tonemap room.exr -o room.png --false-colour cd/m2 --range "
                            "1:1000\n"},
    .run = run,
};
