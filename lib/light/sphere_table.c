// SPDX-License-Identifier: Apache-2.0
#include "light/sphere_table.h"

#include <string.h>

#include "base/mem.h"
#include "light/turn.h"
#include "math/elementary.h"
#include "math/hash.h"

static const float GRID = 0x1p-24f; // step of uniform_float
static const float SMALLEST_SINE = 1e-7f;

// Rounds a running sum onto the grid of the random numbers, so that an entry is drawn exactly as
// often as its width says, and leaves every non-zero entry one step: nothing becomes unreachable.
static void grid_cdf(const double *weights, int count, float *cdf) {
    double total = 0, sum = 0;
    int nonzero = 0, before = 0;
    for (int i = 0; i < count; i++) {
        total += weights[i];
        nonzero += weights[i] > 0;
    }
    const double steps = 0x1p24 - nonzero;
    cdf[0] = 0;
    for (int i = 0; i < count; i++) {
        sum += weights[i];
        before += weights[i] > 0;
        const double share = total > 0 ? sum / total : (i + 1.0) / count;
        cdf[i + 1] = (float)(floor(fmin(share, 1) * steps + 0.5) + before) * GRID;
    }
}

static const float *texel(const struct sphere_table *t, int x, int y) {
    return t->texels[(size_t)y * ((size_t)t->width + 1) + (size_t)x];
}

static spectrum colour(const float c[3]) {
    return spectrum_rgb(c[0], c[1], c[2]);
}

// Four corners of a patch: (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
struct patch {
    float w[4];
    float mean;
};

static struct patch patch_weights(const struct sphere_table *t, int x, int y) {
    struct patch p;
    for (int i = 0; i < 4; i++) {
        const float lum = spectrum_luminance(colour(texel(t, x + (i & 1), y + (i >> 1))) * t->unit);
        p.w[i] = lum * t->row_weight[y + (i >> 1)];
    }
    p.mean = 0.25f * (p.w[0] + p.w[1] + p.w[2] + p.w[3]);
    return p;
}

static void copy_texels(struct sphere_table *t, const float *rgb, int width, int height) {
    float largest = 0;
    t->width = width;
    t->height = height < 2 ? 2 : height;
    t->texels = mem_array((size_t)t->height * ((size_t)width + 1) + 1, sizeof *t->texels);
    for (int y = 0; y < t->height; y++) {
        const float *from = rgb + (size_t)(y < height ? y : height - 1) * (size_t)width * 3;
        float(*to)[3] = t->texels + (size_t)y * ((size_t)width + 1);
        memcpy(to, from, (size_t)width * sizeof *to);
        memcpy(to[width], to[0], sizeof *to);
        for (int x = 0; x < width; x++)
            largest = maxf(largest, spectrum_max(colour(to[x])));
    }
    t->black = !(largest > 0);
    t->unit = t->black ? 1 : 1 / largest;
}

// The integral of sine times a row's hat function is sine times 2 (1 - cos D) / D at distance D of
// the rows, and 1 - sin D / D for the half hat of a pole, which lies in half as many patches.
// Returns the former's factor.
static double init_rows(struct sphere_table *t) {
    t->row_weight = mem_array((size_t)t->height, sizeof *t->row_weight);
    const double step = M_PI / (t->height - 1), hat = 2 * (1 - cos(step)) / step;
    for (int y = 0; y < t->height; y++)
        t->row_weight[y] = (float)sin(y * step);
    t->row_weight[0] = t->row_weight[t->height - 1] = (float)(2 * (1 - sin(step) / step) / hat);
    return hat;
}

void sphere_table_init(struct sphere_table *t, const float *rgb, int width, int height) {
    *t = (struct sphere_table){0};
    copy_texels(t, rgb, width, height);
    const double hat = init_rows(t);
    const int patch_rows = t->height - 1;
    cdf_nodes_init(&t->rows, 1, patch_rows);
    cdf_nodes_init(&t->columns, (size_t)patch_rows, width);
    double *row = mem_array((size_t)width, sizeof *row);
    double *sums = mem_array((size_t)patch_rows, sizeof *sums);
    for (int y = 0; y < patch_rows; y++) {
        for (int x = 0; x < width; x++) {
            row[x] = (double)patch_weights(t, x, y).mean;
            sums[y] += row[x];
        }
        grid_cdf(row, width, cdf_nodes_row(&t->columns, (size_t)y));
        cdf_nodes_index(&t->columns, (size_t)y);
        t->mean += sums[y];
    }
    grid_cdf(sums, patch_rows, cdf_nodes_row(&t->rows, 0));
    cdf_nodes_index(&t->rows, 0);
    t->mean *= hat / (2.0 * width) / (double)t->unit;
    mem_free(row);
    mem_free(sums);
}

void sphere_table_finish(struct sphere_table *t) {
    mem_free(t->texels);
    mem_free(t->row_weight);
    cdf_nodes_finish(&t->rows);
    cdf_nodes_finish(&t->columns);
    *t = (struct sphere_table){0};
}

// ---- look-up

struct place {
    int x, y;     // patch
    float fx, fy; // inside it, 0 to 1
    float sine;   // of the angle from the pole
};

static struct place place_of(const struct sphere_table *t, vec3 w) {
    const float sine = sqrtf(w[0] * w[0] + w[2] * w[2]);
    const float u = turn_of(w[0], -w[2]) * (float)t->width - 0.5f;
    const float v = 2 * turn_of(sine, w[1]) * (float)(t->height - 1);
    const float wrapped = u < 0 ? u + (float)t->width : u;
    struct place p = {.x = (int)wrapped, .y = (int)v, .sine = maxf(sine, SMALLEST_SINE)};
    p.x = p.x < t->width ? p.x : t->width - 1;
    p.y = p.y < t->height - 1 ? p.y : t->height - 2;
    p.fx = clampf(wrapped - (float)p.x, 0, 1);
    p.fy = clampf(v - (float)p.y, 0, 1);
    return p;
}

static spectrum interpolate(const struct sphere_table *t, const struct place *p) {
    const spectrum top = (1 - p->fx) * colour(texel(t, p->x, p->y)) +
                         p->fx * colour(texel(t, p->x + 1, p->y));
    const spectrum bottom = (1 - p->fx) * colour(texel(t, p->x, p->y + 1)) +
                            p->fx * colour(texel(t, p->x + 1, p->y + 1));
    return (1 - p->fy) * top + p->fy * bottom;
}

spectrum sphere_table_eval(const struct sphere_table *t, vec3 w) {
    const struct place p = place_of(t, w);
    return interpolate(t, &p);
}

// pmf of the patch, times its inner density, times d(u,v) / d(solid angle).
static float density(const struct sphere_table *t, const struct place *p, const struct patch *c) {
    const float *rows = cdf_nodes_row(&t->rows, 0);
    const float *row = cdf_nodes_row(&t->columns, (size_t)p->y);
    const float pmf = (rows[p->y + 1] - rows[p->y]) * (row[p->x + 1] - row[p->x]);
    const float top = lerpf(p->fx, c->w[0], c->w[1]), bottom = lerpf(p->fx, c->w[2], c->w[3]);
    if (!(c->mean > 0))
        return 0;
    const float inner = lerpf(p->fy, top, bottom) / c->mean;
    const float patches = (float)t->width * (float)(t->height - 1);
    return pmf * inner * patches / (2 * PI * PI * p->sine);
}

float sphere_table_pdf_sa(const struct sphere_table *t, vec3 w) {
    const struct place p = place_of(t, w);
    const struct patch c = patch_weights(t, p.x, p.y);
    return t->black ? 0 : density(t, &p, &c);
}

// Where a density that runs linearly from a to b over the unit interval puts u.
static float sample_linear(float u, float a, float b) {
    const float largest = maxf(a, b);
    if (!(largest > 0))
        return u;
    a /= largest;
    b /= largest;
    return minf(u * (a + b) / (a + sqrtf(lerpf(u, a * a, b * b))), 1);
}

// The number's place inside its interval. An interval may be a few steps of the grid wide; bits
// below the grid are made up from both numbers, so that places inside stay continuous.
static float inside(const float *cdf, int i, float u, float below) {
    return minf((u - cdf[i] + below * GRID) / (cdf[i + 1] - cdf[i]), 1);
}

bool sphere_table_sample(const struct sphere_table *t, struct vec2 u, vec3 *w, float *pdf_sa,
                         spectrum *value) {
    if (t->black)
        return false;
    struct place p;
    const uint64_t bits = hash_u64((uint64_t)(u.x * 0x1p24f) << 32 | (uint64_t)(u.y * 0x1p24f));
    p.y = (int)cdf_nodes_find(&t->rows, 0, u.y);
    p.x = (int)cdf_nodes_find(&t->columns, (size_t)p.y, u.x);
    const float *row = cdf_nodes_row(&t->columns, (size_t)p.y);
    const struct patch c = patch_weights(t, p.x, p.y);
    const float ux = inside(row, p.x, u.x, uniform_float((uint32_t)bits));
    const float uy = inside(cdf_nodes_row(&t->rows, 0), p.y, u.y, uniform_float((uint32_t)(bits >> 32)));
    p.fy = sample_linear(uy, c.w[0] + c.w[1], c.w[2] + c.w[3]);
    p.fx = sample_linear(ux, lerpf(p.fy, c.w[0], c.w[2]), lerpf(p.fy, c.w[1], c.w[3]));
    const float around = ((float)p.x + p.fx + 0.5f) / (float)t->width;
    float sin_phi, cos_phi, sine, cosine;
    sincos_turn(around - 1, &sin_phi, &cos_phi);
    sincos_turn(0.5f * ((float)p.y + p.fy) / (float)(t->height - 1), &sine, &cosine);
    p.sine = maxf(sine, SMALLEST_SINE);
    *w = v3(sin_phi * sine, cosine, -cos_phi * sine);
    *pdf_sa = density(t, &p, &c);
    *value = interpolate(t, &p);
    return *pdf_sa > 0 && *pdf_sa < INFINITY;
}
