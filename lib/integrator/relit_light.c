// SPDX-License-Identifier: Apache-2.0
#include "integrator/relit_light.h"

#include "base/mem.h"
#include "light/light.h"
#include "math/distribution.h"

enum { HARMONIC_WIDTH = 64, POINTS = 4 }; // cells of harmonics; points a side of each

static const double EVERYWHERE = 0.05; // share of samples that go uniformly

struct relit_light {
    int width, height;
    float *cdf;     // of the cells
    float *density; // of a cell, per solid angle
    float mean, radius;
};

// Mean size of the radiance over a cell, all channels.
static double size_of_cell(const struct source_basis *b, const float *weights, int x, int y, int w,
                           int h) {
    const int n = b->kind == SOURCE_PIXELS ? 1 : POINTS;
    double sum = 0;
    for (int i = 0; i < n * n; i++) {
        double d[3];
        latlong_direction(x + (i % n + 0.5) / n, y + (i / n + 0.5) / n, w, h, d);
        const spectrum r = lighting_radiance(b, weights, v3((float)d[0], (float)d[1], (float)d[2]));
        for (int c = 0; c < 3; c++)
            sum += fabs((double)r[c]) / (3.0 * n * n);
    }
    return sum;
}

struct relit_light *relit_light_make(const struct source_basis *b, const float *weights, float radius,
                                     struct arena *arena) {
    struct relit_light *l = arena_alloc(arena, sizeof *l);
    const int w = b->kind == SOURCE_PIXELS ? b->width : HARMONIC_WIDTH, h = w / 2;
    const size_t n = (size_t)w * (size_t)h;
    double *power = mem_array(n, sizeof *power), total = 0, sum = 0;
    for (size_t i = 0; i < n; i++) {
        const int x = (int)(i % (size_t)w), y = (int)(i / (size_t)w);
        power[i] = size_of_cell(b, weights, x, y, w, h) * latlong_solid_angle(y, w, h);
        total += power[i];
    }
    *l = (struct relit_light){w, h, arena_alloc(arena, (n + 1) * sizeof *l->cdf),
                              arena_alloc(arena, n * sizeof *l->density),
                              (float)(total / (4 * M_PI)), radius};
    for (size_t i = 0; i < n; i++) {
        const double omega = latlong_solid_angle((int)(i / (size_t)w), w, h);
        const double even = omega / (4 * M_PI);
        sum += total > 0 ? EVERYWHERE * even + (1 - EVERYWHERE) * power[i] / total : even;
        l->cdf[i + 1] = i + 1 < n ? (float)sum : 1;
        l->density[i] = (l->cdf[i + 1] - l->cdf[i]) / (float)omega;
    }
    mem_free(power);
    return l;
}

static float pdf_sa(const void *data, vec3 p, const struct light_hit *hit) {
    const struct relit_light *l = data;
    const float d[3] = {hit->wi[0], hit->wi[1], hit->wi[2]};
    (void)p;
    return l->density[latlong_cell(d, l->width, l->height)];
}

// Evenly in the solid angle of a cell.
static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    const struct relit_light *l = data;
    float across;
    const uint32_t i = cdf_find(l->cdf, (uint32_t)(l->width * l->height), u.x, &across);
    const int x = (int)i % l->width, y = (int)i / l->width;
    const double top = cos(M_PI * y / l->height), end = cos(M_PI * (y + 1) / l->height);
    double d[3];
    latlong_direction(x + (double)across, acos(top + (end - top) * (double)u.y) / M_PI * l->height,
                      l->width, l->height, d);
    const vec3 wi = normalize(v3((float)d[0], (float)d[1], (float)d[2]));
    *s = (struct light_sample){.wi = wi, .distance = INFINITY, .emission = spectrum_grey(1),
                               .pdf_sa = pdf_sa(data, p, &(struct light_hit){.wi = wi})};
    return s->pdf_sa > 0;
}

static spectrum emission(const void *data, const struct light_hit *hit) {
    (void)data, (void)hit;
    return spectrum_grey(1);
}

static float power(const void *data) {
    const struct relit_light *l = data;
    return light_power_infinite(l->mean, l->radius);
}

const struct light_type relit_light_type = {
    .entry = {.name = "relit", .size = sizeof(struct relit_light)}, .infinite = true,
    .sample = sample, .emission = emission, .pdf_sa = pdf_sa, .power = power,
};
