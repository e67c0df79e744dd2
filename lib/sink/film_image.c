// SPDX-License-Identifier: Apache-2.0
// From sums to a picture: means, layers, standard errors.
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "math/vec.h"
#include "sink/film_layout.h"

static const double LUMINANCE[3] = {0.212671, 0.715160, 0.072169}; // of linear Rec.709
static const double NOT_HIT_Z = 1e10; // depth of pixels that see nothing, as compositors expect

const char *const film_path_names[PATH_SLOTS] = {
    "direct_diffuse",   "direct_glossy",     "direct_specular", "indirect_diffuse",
    "indirect_glossy", "indirect_specular", "emission"};

// Squared standard error of the mean from the means of the replicates that have samples.
static void squared_error(const struct film_counts *n, const double *replicates, double error[3]) {
    uint32_t used = 0;
    for (uint32_t r = 0; r < FILM_REPLICATES; r++)
        used += n->replicate[r] > 0;
    for (uint32_t c = 0; c < 3; c++) {
        double mean = 0, spread = 0;
        for (uint32_t r = 0; r < FILM_REPLICATES; r++)
            mean += replicates[3 * r + c] / (double)n->all;
        for (uint32_t r = 0; r < FILM_REPLICATES; r++)
            if (n->replicate[r]) {
                const double d = replicates[3 * r + c] / (double)n->replicate[r] - mean;
                spread += d * d;
            }
        error[c] = used > 1 ? spread / ((double)used * (used - 1)) : 0;
    }
}

// The picture's colour: the beauty slot, or the sum of the light groups.
static void pixel_colour(const struct film_layout *l, const struct film_options *o,
                         const double *sums, double scale, double rgb[3]) {
    const uint32_t first = l->group_slot != LAYOUT_NONE ? l->group_slot : l->beauty_slot;
    const uint32_t count = l->group_slot != LAYOUT_NONE ? o->group_count : 1;
    for (int c = 0; c < 3; c++) {
        rgb[c] = 0;
        for (uint32_t g = 0; g < count; g++)
            rgb[c] += sums[3 * (first + g) + (uint32_t)c] * scale;
    }
}

double film_clamped(const struct film *f) {
    const struct film_layout *l = film_get_layout(f);
    const struct film_options *o = film_get_options(f);
    double *sums, kept = 0, lost = 0;
    if (l->clamp_slot == LAYOUT_NONE || film_samples(f) == 0)
        return -1;
    sums = mem_array(l->channels, sizeof *sums);
    for (int y = o->y0; y < o->y1; y++)
        for (int x = o->x0; x < o->x1; x++) {
            double rgb[3];
            struct film_counts n;
            film_pixel(f, x, y, sums);
            film_pixel_counts(f, x, y, &n);
            pixel_colour(l, o, sums, 1.0 / (double)n.all, rgb);
            for (uint32_t c = 0; c < 3; c++) {
                kept += LUMINANCE[c] * rgb[c];
                lost += LUMINANCE[c] * sums[3 * l->clamp_slot + c] / (double)n.all;
            }
        }
    mem_free(sums);
    return kept + lost > 0 ? lost / (kept + lost) : 0;
}

// ---- channels -----------------------------------------------------------------------------------

struct writer {
    struct image *im; // is named
    float *pixel;     // is written; both NULL: channels are only counted
    int next;
};

// Declares one channel.
static void put(struct writer *w, const char *layer, const char *channel, double value) {
    if (w->pixel)
        w->pixel[w->next] = (float)value;
    else if (w->im)
        snprintf(w->im->channel_names[w->next], sizeof w->im->channel_names[0], "%s%s%s", layer,
                 *layer ? "." : "", channel);
    w->next++;
}

static void put_rgb(struct writer *w, const char *layer, const double *sums, double scale) {
    static const char *const names[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; c++)
        put(w, layer, names[c], sums[c] * scale);
}

static const double *put_xyz(struct writer *w, const char *layer, const double *sums, double scale) {
    static const char *const names[3] = {"X", "Y", "Z"};
    for (int c = 0; c < 3; c++)
        put(w, layer, names[c], sums[c] * scale);
    return sums + 3;
}

static void put_aovs(struct writer *w, const struct film_layout *l, const double *sums,
                     double samples) {
    const double *in = sums + l->aov_channel;
    const double hits = *in++;
    const double all = 1 / samples, hit = hits > 0 ? 1 / hits : 0;
    if (l->aovs & AOV_ALBEDO) {
        put_rgb(w, "albedo", in, all);
        in += 3;
    }
    if (l->aovs & AOV_N)
        in = put_xyz(w, "N", in, hit);
    if (l->aovs & AOV_NG)
        in = put_xyz(w, "Ng", in, hit);
    if (l->aovs & AOV_Z)
        put(w, "", "Z", hits > 0 ? *in++ * hit : (in++, NOT_HIT_Z));
    if (l->aovs & AOV_P)
        in = put_xyz(w, "P", in, hit);
    if (l->aovs & AOV_UV) {
        put(w, "uv", "U", *in++ * hit);
        put(w, "uv", "V", *in++ * hit);
    }
    if (l->aovs & AOV_SHAPE)
        put(w, "shape", "Y", *in++);
    if (l->aovs & AOV_INSTANCE)
        put(w, "instance", "Y", *in++);
}

// All channels of one pixel, in the order of the file.
static void put_pixel(struct writer *w, const struct film *f, const struct film_counts *n,
                      const double *sums) {
    const struct film_layout *l = film_get_layout(f);
    const struct film_options *o = film_get_options(f);
    const double scale = 1.0 / (double)n->all;
    double rgb[3];
    pixel_colour(l, o, sums, scale, rgb);
    put_rgb(w, "", rgb, 1);
    if (l->alpha_channel != LAYOUT_NONE)
        put(w, "", "A", sums[l->alpha_channel] * scale);
    for (uint32_t g = 0; g < o->group_count; g++)
        put_rgb(w, o->group_names[g], sums + 3 * (l->group_slot + g), scale);
    for (uint32_t i = 0; l->path_slot != LAYOUT_NONE && i < PATH_SLOTS; i++)
        put_rgb(w, film_path_names[i], sums + 3 * (l->path_slot + i), scale);
    if (l->clamp_slot != LAYOUT_NONE)
        put_rgb(w, "clamped", sums + 3 * l->clamp_slot, scale);
    if (l->moment_channel != LAYOUT_NONE)
        put_rgb(w, "m2", sums + l->moment_channel, scale);
    if (l->replicate_channel != LAYOUT_NONE) {
        double error[3];
        squared_error(n, sums + l->replicate_channel, error);
        put_rgb(w, "variance", error, 1);
    }
    if (o->map)
        put(w, "samples", "Y", (double)n->all);
    if (l->aov_channel != LAYOUT_NONE)
        put_aovs(w, l, sums, (double)n->all);
}

bool film_image_head(const struct film *f, struct image *im) {
    const struct film_options *o = film_get_options(f);
    double *sums = mem_array(film_get_layout(f)->channels, sizeof *sums);
    struct film_counts n;
    struct writer w = {0};
    film_pixel_counts(f, o->x0, o->y0, &n);
    put_pixel(&w, f, &n, sums);
    const bool made = image_init_head(im, o->x1 - o->x0, o->y1 - o->y0, w.next);
    w = (struct writer){.im = im};
    if (made)
        put_pixel(&w, f, &n, sums); // names
    mem_free(sums);
    return made;
}

void film_rows(const void *film, int y, int rows, float *pixels) {
    const struct film_options *o = film_get_options(film);
    double *sums = mem_array(film_get_layout(film)->channels, sizeof *sums);
    struct film_counts n;
    for (int i = o->y0 + y; i < o->y0 + y + rows; i++)
        for (int x = o->x0; x < o->x1; x++) {
            struct writer w = {.pixel = pixels};
            film_pixel(film, x, i, sums);
            film_pixel_counts(film, x, i, &n);
            put_pixel(&w, film, &n, sums);
            pixels += w.next;
        }
    mem_free(sums);
}

struct development {
    const struct film *film;
    struct image *im;
};

static void develop_row(void *ctx, size_t row, int worker) {
    const struct development *d = ctx;
    (void)worker;
    film_rows(d->film, (int)row, 1,
              d->im->pixels + row * (size_t)d->im->width * (size_t)d->im->channels);
}

void film_image_pixels(const struct film *f, struct image *im) {
    image_add_pixels(im);
    thread_for(0, (size_t)im->height, develop_row, &(struct development){f, im});
}

bool film_image(const struct film *f, struct image *im) {
    if (!film_image_head(f, im))
        return false;
    film_image_pixels(f, im);
    return true;
}
