// SPDX-License-Identifier: Apache-2.0
// The noise of a picture: the mean over pixels of SE^2 / (b^2 + floor), of grey values.
//
// SE^2 comes from the deviations d of the replicates from their mean; the trouble is b. Where b is the
// pixel itself, a rare bright sample raises d and b alike, and hides: told 0.45 to 0.3 times the
// spread of independent pictures on veach-mis. Where b is the other replicates, the pixels at the edge
// of a lamp, most of whose light one replicate may hold, count without limit: up to 3 times. So the
// replicate that deviates takes part in b, but with no more than the other replicates or a pixel beside
// it hold: bright samples at a lamp's edge are expected, those on a dark wall are not. Within 8 %
// there (tests/render/noise).
#include <math.h>

#include "base/mem.h"
#include "base/thread.h"
#include "sink/film_layout.h"

struct greys {
    const struct film *film;
    int width, height;
    double *values, mean;
    double *errors; // squared, relative
};

// Sum of grey values of a replicate.
static double grey(const double *replicates, uint32_t r) {
    return (replicates[3 * r] + replicates[3 * r + 1] + replicates[3 * r + 2]) / 3;
}

static void find_greys(void *greys, size_t row, int worker) {
    const struct greys *g = greys;
    const struct film_options *o = film_get_options(g->film);
    double sums[3 * FILM_REPLICATES];
    (void)worker;
    for (int x = 0; x < g->width; x++) {
        double *value = g->values + row * (size_t)g->width + (size_t)x;
        struct film_counts n;
        film_pixel_replicates(g->film, o->x0 + x, o->y0 + (int)row, sums);
        film_pixel_counts(g->film, o->x0 + x, o->y0 + (int)row, &n);
        for (uint32_t r = 0; r < FILM_REPLICATES; r++)
            *value += grey(sums, r) / (double)n.all;
    }
}

// The brightest of the up to eight pixels around one.
static double brightest_around(const struct greys *g, int x, int y) {
    double most = 0;
    for (int j = y > 0 ? y - 1 : 0; j <= y + 1 && j < g->height; j++)
        for (int i = x > 0 ? x - 1 : 0; i <= x + 1 && i < g->width; i++)
            if (i != x || j != y)
                most = fmax(most, g->values[j * g->width + i]);
    return most;
}

// Squared relative error of a pixel. `around`: grey value that is nothing unusual there.
static double relative_error(const struct film_counts *n, const double *replicates, double around,
                             double floor) {
    double sums[FILM_REPLICATES], all = 0, error = 0;
    uint32_t used = 0;
    for (uint32_t r = 0; r < FILM_REPLICATES; r++) {
        all += sums[r] = grey(replicates, r);
        used += n->replicate[r] > 0;
    }
    for (uint32_t r = 0; r < FILM_REPLICATES && used > 1; r++) {
        const double own = (double)n->replicate[r], others = (double)n->all - own;
        if (own == 0)
            continue;
        const double d = sums[r] / own - all / (double)n->all;
        const double most = own * fmax(around, (all - sums[r]) / others);
        const double b = (all - sums[r] + fmin(sums[r], most)) / (double)n->all;
        const double scale = b * b + floor;
        error += scale > 0 ? d * d / scale / ((double)used * (used - 1)) : 0;
    }
    return error;
}

static void find_errors(void *greys, size_t row, int worker) {
    const struct greys *g = greys;
    const struct film_options *o = film_get_options(g->film);
    double sums[3 * FILM_REPLICATES], *errors = g->errors + row * (size_t)g->width;
    (void)worker;
    for (int x = 0; x < g->width; x++) {
        struct film_counts n;
        film_pixel_replicates(g->film, o->x0 + x, o->y0 + (int)row, sums);
        film_pixel_counts(g->film, o->x0 + x, o->y0 + (int)row, &n);
        errors[x] = relative_error(&n, sums, brightest_around(g, x, (int)row),
                                   1e-3 * g->mean * g->mean);
    }
}

// Rows are looked at by several threads, and summed by one in their order.
double film_noise(const struct film *f) {
    const struct film_options *o = film_get_options(f);
    if (film_get_layout(f)->replicate_channel == LAYOUT_NONE || film_samples(f) < 2)
        return -1;
    struct greys g = {.film = f, .width = o->x1 - o->x0, .height = o->y1 - o->y0};
    const size_t pixels = (size_t)g.width * (size_t)g.height;
    double noise = 0;
    g.values = mem_array(2 * pixels, sizeof *g.values);
    g.errors = g.values + pixels;
    thread_for(0, (size_t)g.height, find_greys, &g);
    for (size_t i = 0; i < pixels; i++)
        g.mean += g.values[i] / (double)pixels;
    thread_for(0, (size_t)g.height, find_errors, &g);
    for (size_t i = 0; i < pixels; i++)
        noise += g.errors[i];
    mem_free(g.values);
    return sqrt(noise / (double)pixels);
}
