// SPDX-License-Identifier: Apache-2.0
// sphere_table_sample for a pair of numbers a lane, operation by operation. The table is larger than
// caches: all lanes of all groups send for what one stage reads before any of them reads it.
#include "light/sphere_table.h"
#include "math/wide_elementary.h"
#include "math/wide_hash.h"

static const float GRID = 0x1p-24f; // step of uniform_float
static const float SMALLEST_SINE = 1e-7f;

// The patches of all lanes.
struct patches {
    const struct sphere_patches *at;
    const float *texel[WIDE_LANES]; // at their first corner
    wide left, right, top, bottom;  // sums at their edges
    wide row_weight[2];
    struct wide3 colour[4];         // of the corners, as struct patch has them
    wide w[4], mean;
};

// A pair of texels may lie across the end of a line.
static void prefetch_pair(const float *texel) {
    __builtin_prefetch(texel);
    __builtin_prefetch(texel + 5);
}

void sphere_table_find_wide(const struct sphere_table *t, int groups, const wide u[][2],
                            struct sphere_patches found[]) {
    enum { MOST = LIGHT_GROUPS * WIDE_LANES };
    static const uint32_t only[MOST] = {0};
    const size_t stride = (size_t)t->width + 1;
    float numbers[2][MOST];
    uint32_t x[MOST], y[MOST];
    for (int g = 0; g < groups; g++)
        for (int k = 0; k < 2; k++)
            memcpy(numbers[k] + g * WIDE_LANES, &u[g][k], sizeof u[g][k]);
    cdf_nodes_find_all(&t->rows, groups * WIDE_LANES, only, numbers[1], y);
    cdf_nodes_find_all(&t->columns, groups * WIDE_LANES, y, numbers[0], x);
    for (int i = 0; i < groups * WIDE_LANES; i++) {
        const float *texel = t->texels[y[i] * stride + x[i]];
        prefetch_pair(texel);
        prefetch_pair(texel + 3 * stride);
    }
    for (int g = 0; g < groups; g++) {
        memcpy(found[g].x, x + g * WIDE_LANES, sizeof found[g].x);
        memcpy(found[g].y, y + g * WIDE_LANES, sizeof found[g].y);
    }
}

// In memory: a vector whose lanes are set one by one waits for each.
static void load_sums(const struct sphere_table *t, struct patches *p) {
    float sums[4][WIDE_LANES], weights[2][WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++) {
        const float *rows = cdf_nodes_row(&t->rows, 0) + p->at->y[i];
        const float *columns = cdf_nodes_row(&t->columns, p->at->y[i]) + p->at->x[i];
        for (int k = 0; k < 2; k++) {
            sums[k][i] = rows[k];
            sums[k + 2][i] = columns[k];
            weights[k][i] = t->row_weight[p->at->y[i] + (uint32_t)k];
        }
    }
    p->top = wide_load(sums[0]);
    p->bottom = wide_load(sums[1]);
    p->left = wide_load(sums[2]);
    p->right = wide_load(sums[3]);
    for (int k = 0; k < 2; k++)
        p->row_weight[k] = wide_load(weights[k]);
}

static void weigh_corners(const struct sphere_table *t, struct patches *p) {
    const size_t below = 3 * ((size_t)t->width + 1);
    for (size_t k = 0; k < 4; k++) {
        const float *corner[WIDE_LANES];
        wide c[4];
        for (int i = 0; i < WIDE_LANES; i++)
            corner[i] = p->texel[i] + 3 * (k & 1) + below * (k >> 1);
        wide_gather4(corner, c);
        p->colour[k] = (struct wide3){c[0], c[1], c[2]};
        const wide luminance = 0.212671f * (c[0] * t->unit) + 0.715160f * (c[1] * t->unit) +
                               0.072169f * (c[2] * t->unit);
        p->w[k] = luminance * p->row_weight[k >> 1];
    }
    p->mean = 0.25f * (p->w[0] + p->w[1] + p->w[2] + p->w[3]);
}

static wide mix(wide t, wide a, wide b) {
    return (1 - t) * a + t * b;
}

static struct wide3 mix3(wide t, struct wide3 a, struct wide3 b) {
    return wide3_add(wide3_scale(1 - t, a), wide3_scale(t, b));
}

static wide sample_linear(wide u, wide a, wide b) {
    const wide largest = wide_max(a, b), from = a / largest, to = b / largest;
    const wide root = wide_sqrt(mix(u, from * from, to * to));
    return wide_select(largest > 0, wide_min(u * (from + to) / (from + root), wide_of(1)), u);
}

static wide inside(wide begin, wide end, wide u, wide below) {
    return wide_min((u - begin + below * GRID) / (end - begin), wide_of(1));
}

// Places inside the patches.
static void place(const struct patches *p, const wide u[2], wide *fx, wide *fy) {
    const struct wide_u64 bits =
        wide_hash_u64(wide_join((wide_uint)__builtin_convertvector(u[0] * 0x1p24f, wide_int),
                                (wide_uint)__builtin_convertvector(u[1] * 0x1p24f, wide_int)));
    const wide ux = inside(p->left, p->right, u[0], wide_uniform_float(wide_low_word(bits)));
    const wide uy = inside(p->top, p->bottom, u[1], wide_uniform_float(wide_high_word(bits)));
    *fy = sample_linear(uy, p->w[0] + p->w[1], p->w[2] + p->w[3]);
    *fx = sample_linear(ux, mix(*fy, p->w[0], p->w[2]), mix(*fy, p->w[1], p->w[3]));
}

static wide density(const struct sphere_table *t, const struct patches *p, wide fx, wide fy,
                    wide sine) {
    const wide pmf = (p->bottom - p->top) * (p->right - p->left);
    const wide top = mix(fx, p->w[0], p->w[1]), bottom = mix(fx, p->w[2], p->w[3]);
    const wide inner = mix(fy, top, bottom) / p->mean;
    const float patches = (float)t->width * (float)(t->height - 1);
    const wide pdf = pmf * inner * patches / (2 * PI * PI * sine);
    return wide_select(p->mean > 0, pdf, wide_of(0));
}

static wide numbers(const uint32_t v[WIDE_LANES]) {
    wide_int n;
    memcpy(&n, v, sizeof n);
    return __builtin_convertvector(n, wide);
}

wide_mask sphere_table_sample_wide(const struct sphere_table *t, const struct sphere_patches *at,
                                   const wide u[2], struct wide3 *w, wide *pdf_sa,
                                   struct wide3 *value) {
    const size_t stride = (size_t)t->width + 1;
    struct patches p = {.at = at};
    wide fx, fy, sin_phi, cos_phi, sine, cosine;
    if (t->black)
        return wide_mask_of(0);
    for (int i = 0; i < WIDE_LANES; i++)
        p.texel[i] = t->texels[at->y[i] * stride + at->x[i]];
    load_sums(t, &p);
    weigh_corners(t, &p);
    place(&p, u, &fx, &fy);
    wide_sincos_turn((numbers(at->x) + fx + 0.5f) / (float)t->width - 1, &sin_phi, &cos_phi);
    wide_sincos_turn(0.5f * (numbers(at->y) + fy) / (float)(t->height - 1), &sine, &cosine);
    *w = (struct wide3){sin_phi * sine, cosine, -cos_phi * sine};
    *pdf_sa = density(t, &p, fx, fy, wide_max(sine, wide_of(SMALLEST_SINE)));
    *value = mix3(fy, mix3(fx, p.colour[0], p.colour[1]), mix3(fx, p.colour[2], p.colour[3]));
    return wide_both(*pdf_sa > 0, *pdf_sa < INFINITY);
}
