// SPDX-License-Identifier: Apache-2.0
// Colours: viridis of matplotlib (S. van der Walt and N. Smith 2015, CC0), whose lightness rises
// evenly, so that it reads in grey too; every seventeenth of its 256 entries.
#include "image/false_colour.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/log.h"
#include "base/mem.h"
#include "image/lettering.h"

enum { STOPS = 16, LEGEND_WIDTH = 96, BAR_WIDTH = 18, MARGIN = 12, LEAST_HEIGHT = 96 };

static const unsigned viridis[STOPS] = {
    0x440154, 0x481a6c, 0x472f7d, 0x414487, 0x39568c, 0x31688e, 0x2a788e, 0x23888e, 0x1f988b,
    0x22a884, 0x35b779, 0x54c568, 0x7ad151, 0xa5db36, 0xd2e21b, 0xfde725,
};

// Display values as linear ones, which the writer encodes again.
static void colour_at(double t, float out[3]) {
    const double x = (t > 0 ? t < 1 ? t : 1 : 0) * (STOPS - 1);
    const int i = x < STOPS - 1 ? (int)x : STOPS - 2;
    for (int c = 0; c < 3; c++) {
        const double a = viridis[i] >> (16 - 8 * c) & 255, b = viridis[i + 1] >> (16 - 8 * c) & 255;
        out[c] = srgb_to_linear((float)((a + (x - i) * (b - a)) / 255));
    }
}

struct scale {
    double low, high; // > 0 unless linear
    bool linear;
};

static double place(const struct scale *s, double v) {
    if (s->linear)
        return (v - s->low) / (s->high - s->low);
    return v > s->low ? log(v / s->low) / log(s->high / s->low) : 0;
}

static double luminance_at(const struct image *rgb, size_t pixel, double factor) {
    const double v = factor * (double)rgb_luminance(rgb->pixels + 3 * pixel);
    return v > 0 && v < INFINITY ? v : 0;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// The picture's own range: a few bright pixels are beyond it, and so is what is a thousand times
// darker, rounded outwards to 1, 2 or 5 times a power of ten.
static double round_number(double v, bool up) {
    static const double steps[] = {1, 2, 5, 10};
    const double decade = pow(10, floor(log10(v)));
    int i = 0;
    while (i < 3 && steps[i + 1] * decade <= v * (1 + 1e-9))
        i++;
    return steps[up && steps[i] * decade < v * (1 - 1e-9) ? i + 1 : i] * decade;
}

static struct scale choose_scale(const struct image *rgb, const struct false_colour *o) {
    struct scale s = {o->low, o->high, o->linear};
    const size_t pixels = (size_t)rgb->width * (size_t)rgb->height;
    if (s.high > s.low && (s.linear || s.low > 0))
        return s;
    double *v = mem_array(pixels, sizeof *v);
    size_t count = 0;
    for (size_t i = 0; i < pixels; i++) {
        v[count] = luminance_at(rgb, i, o->factor);
        count += v[count] > 0;
    }
    qsort(v, count, sizeof *v, ascending);
    const double high = count ? v[(size_t)((double)(count - 1) * 0.998)] : 1;
    const double low = count ? v[(size_t)((double)(count - 1) * 0.01)] : 1;
    mem_free(v);
    s.high = round_number(high, true);
    s.low = s.linear ? 0 : fmax(round_number(fmin(low, s.high / 10), false), s.high * 1e-3);
    return s;
}

// ---- legend -------------------------------------------------------------------------------------

static void fill(struct image *im, int x0, int y0, int x1, int y1, const float colour[3]) {
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            for (int c = 0; c < 3; c++)
                im->pixels[3 * ((size_t)y * (size_t)im->width + (size_t)x) + (size_t)c] = colour[c];
}

static void draw_tick(struct image *im, int x, const struct scale *s, double v) {
    static const float ink[3] = {1, 1, 1};
    char text[32];
    const int top = 2 * MARGIN + LETTERING_HEIGHT, bottom = im->height - MARGIN;
    const int y = bottom - 1 - (int)(place(s, v) * (bottom - 1 - top) + 0.5);
    fill(im, x + BAR_WIDTH, y, x + BAR_WIDTH + 4, y + 1, ink);
    snprintf(text, sizeof text, "%g", v);
    lettering_draw(im, x + BAR_WIDTH + 7, y - LETTERING_HEIGHT / 2, text, ink);
}

// Labels at 1, 2, 5 times powers of ten, as many as there is room for.
static void draw_ticks(struct image *im, int x, const struct scale *s) {
    static const int every[][3] = {{1, 2, 5}, {1, 5, 0}, {1, 0, 0}};
    const double decades = log10(s->high / s->low);
    const int room = im->height / (2 * LETTERING_HEIGHT);
    const int kind = 3 * decades < room ? 0 : 2 * decades < room ? 1 : 2;
    const double first = pow(10, floor(log10(s->low)));
    for (double decade = first; decade <= s->high * (1 + 1e-9); decade *= 10)
        for (int i = 0; i < 3 && every[kind][i]; i++) {
            const double v = every[kind][i] * decade;
            if (v >= s->low * (1 - 1e-9) && v <= s->high * (1 + 1e-9))
                draw_tick(im, x, s, v);
        }
}

static void draw_legend(struct image *im, int left, const struct scale *s, const char *unit) {
    static const float paper[3] = {0.02f, 0.02f, 0.02f}, ink[3] = {1, 1, 1};
    const int top = 2 * MARGIN + LETTERING_HEIGHT, bottom = im->height - MARGIN, x = left + MARGIN;
    fill(im, left, 0, im->width, im->height, paper);
    lettering_draw(im, x, MARGIN, unit, ink);
    for (int y = top; y < bottom; y++) {
        float colour[3];
        colour_at((double)(bottom - 1 - y) / (bottom - 1 - top), colour);
        fill(im, x, y, x + BAR_WIDTH, y + 1, colour);
    }
    if (!s->linear)
        draw_ticks(im, x, s);
    else
        for (int i = 0; i <= 5; i++)
            draw_tick(im, x, s, s->low + i * (s->high - s->low) / 5);
}

bool false_colour_map(const struct image *rgb, const struct false_colour *o, struct image *out) {
    const struct scale scale = choose_scale(rgb, o);
    const int height = rgb->height > LEAST_HEIGHT ? rgb->height : LEAST_HEIGHT;
    if (!image_init(out, rgb->width + LEGEND_WIDTH, height, 3))
        return false;
    for (int y = 0; y < rgb->height; y++)
        for (int x = 0; x < rgb->width; x++) {
            const size_t from = (size_t)y * (size_t)rgb->width + (size_t)x;
            const size_t to = (size_t)y * (size_t)out->width + (size_t)x;
            colour_at(place(&scale, luminance_at(rgb, from, o->factor)), out->pixels + 3 * to);
        }
    draw_legend(out, rgb->width, &scale, o->unit);
    return true;
}
