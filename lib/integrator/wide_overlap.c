// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_overlap.h"

#include <string.h>

#include "integrator/wide_split.h"
#include "math/wide_double.h"

void wide_overlap_init(struct wide_overlap *o, const struct gamma *const gamma[OVERLAP_AXES],
                       const struct basis *const basis[OVERLAP_AXES], uint32_t axes, struct arena *arena) {
    overlap_init(&o->scalar, gamma, basis, axes, arena);
    for (uint32_t i = 0; i < axes; i++)
        wide_axis_init(&o->axis[i], &o->scalar.axis[i], arena);
}

void wide_overlap_fit(const struct wide_overlap *o, const struct wide_nodes *n,
                      wide gamma[OVERLAP_AXES][OVERLAP_NODES], struct wide_fit fit[OVERLAP_AXES]) {
    for (uint32_t x = 0; x < o->scalar.axes; x++)
        wide_fit_make(&fit[x], &o->axis[x], gamma[x], n->part, n->tolerance);
}

// ---- to the sums --------------------------------------------------------------------------------

// Adds share[i] * light[c] to sum[3 i + c].
static inline void add_half(double *sum, const wide_double light[OVERLAP_CHANNELS], wide_double share) {
    wide_double old[OVERLAP_CHANNELS];
    memcpy(old, sum, sizeof old);
    old[0] += light[0] * __builtin_shufflevector(share, share, WIDE_THRICE_0);
    old[1] += light[1] * __builtin_shufflevector(share, share, WIDE_THRICE_1);
    old[2] += light[2] * __builtin_shufflevector(share, share, WIDE_THRICE_2);
    memcpy(sum, old, sizeof old);
}

// Three numbers, over and over.
struct lit {
    wide_double pattern[OVERLAP_CHANNELS];
};

static struct lit lit_of(const double l[OVERLAP_CHANNELS]) {
    struct lit lit;
    double all[OVERLAP_CHANNELS * WIDE_HALF];
    for (int i = 0; i < OVERLAP_CHANNELS * WIDE_HALF; i++)
        all[i] = l[i % OVERLAP_CHANNELS];
    memcpy(lit.pattern, all, sizeof all);
    return lit;
}

// Shares of functions from `first` on, of which no more than `count` are not 0.
static inline void add_shares(double *sums, size_t first, uint32_t count, const struct lit *l, wide share) {
    add_half(sums + first * OVERLAP_CHANNELS, l->pattern, wide_half_to_double(share, 0));
    if (count > WIDE_HALF)
        add_half(sums + (first + WIDE_HALF) * OVERLAP_CHANNELS, l->pattern,
                  wide_half_to_double(share, 1));
}

// ---- one curve ----------------------------------------------------------------------------------

// The parts of a triangle.
static struct part_run run_of(const struct wide_overlap *o, uint32_t x, const struct wide_fit *f,
                              const struct wide_nodes *n, uint32_t lane, bool fine,
                              struct part room[FIT_FINE]) {
    struct part_run r = {f->part[lane], FIT_COARSE, f->first[lane], f->count[lane], f->straddles >> lane & 1};
    float weight[FIT_FINE];
    if (!fine)
        return r;
    for (int i = 0; i < FIT_FINE; i++)
        weight[i] = 0.25f * n->part[i / 4][lane];
    wide_fit_fine(f, &o->axis[x], lane, weight, !(f->finer >> lane & 1), room);
    r.part = room;
    r.parts = FIT_FINE;
    return r;
}

static void add_vector(struct wide_overlap *o, const struct part_run *r, const struct lit *l) {
    const struct wide_axis *a = &o->axis[0];
    float done = 0;
    for (uint32_t at = 0; at < r->count; at += part_step(a))
        add_shares(o->scalar.sums, r->first + at, r->count - at, l, part_shares(a, r, at, &done));
}

static void add_split(struct wide_overlap *o, const struct wide_fit *f, const struct wide_nodes *n,
                      uint32_t lane, const double light[OVERLAP_CHANNELS]) {
    struct overlap *s = &o->scalar;
    wide_split_add(o, 0, n, lane, f->gamma);
    for (uint32_t j = s->touched[0].first; j < s->touched[0].end; j++) {
        for (int c = 0; c < OVERLAP_CHANNELS; c++)
            s->sums[j * OVERLAP_CHANNELS + (uint32_t)c] += light[c] * s->margin[0][j];
        s->margin[0][j] = 0;
    }
    s->touched[0] = (struct overlap_range){0, 0};
}

// ---- two curves ---------------------------------------------------------------------------------

// Shares of each part in functions of an axis from `at` on.
static void find_rows(const struct wide_axis *a, const struct part_run *r, uint32_t at,
                      float done[FIT_FINE], wide rows[FIT_FINE]) {
    struct part_run one = *r;
    one.parts = 1;
    for (uint32_t p = 0; p < r->parts; p++) {
        one.part = &r->part[p];
        rows[p] = part_shares(a, &one, at, &done[p]);
    }
}

// Calls `add` with the products of shares, [row][WIDE_LANES columns].
static void find_products(struct wide_overlap *o, const struct part_run *a, const struct part_run *b,
                          const struct lit *l, void (*add)(struct wide_overlap *o, size_t at, uint32_t count,
                                                           const struct lit *l, wide product)) {
    float done_a[FIT_FINE] = {0};
    wide rows[FIT_FINE], columns[FIT_FINE];
    for (uint32_t i = 0; i < a->count; i += part_step(&o->axis[0])) {
        float done_b[FIT_FINE] = {0};
        find_rows(&o->axis[0], a, i, done_a, rows);
        for (uint32_t p = 0; p < a->parts; p++)
            rows[p] *= 1 / b->part[p].weight; // it is in both
        for (uint32_t k = 0; k < b->count; k += part_step(&o->axis[1])) {
            find_rows(&o->axis[1], b, k, done_b, columns);
            for (uint32_t j = 0; j < part_step(&o->axis[0]) && i + j < a->count; j++) {
                wide product = wide_of(0);
                for (uint32_t p = 0; p < a->parts; p++)
                    product += rows[p][j] * columns[p];
                add(o, (a->first + i + j) * (size_t)o->scalar.axis[1].basis.count + b->first + k,
                    b->count - k, l, product);
            }
        }
    }
}

static void add_lit(struct wide_overlap *o, size_t at, uint32_t count, const struct lit *l, wide product) {
    add_shares(o->scalar.sums, at, count, l, product);
}

static void add_joint(struct wide_overlap *o, size_t at, uint32_t count, const struct lit *l, wide product) {
    (void)l;
    for (uint32_t c = 0; c < WIDE_LANES && c < count; c++)
        o->scalar.joint[at + c] += (double)product[c];
}

// One of them bends too much: each alone as with one curve, and both brought to that.
static void add_fitted(struct wide_overlap *o, const struct wide_fit fit[OVERLAP_AXES],
                       const struct wide_nodes *n, uint32_t lane, const struct overlap_triangle *t,
                       const double light[OVERLAP_CHANNELS]) {
    struct part room[OVERLAP_AXES][FIT_FINE];
    struct part_run r[OVERLAP_AXES];
    for (uint32_t x = 0; x < OVERLAP_AXES; x++) {
        const struct wide_fit *f = &fit[x];
        if (f->splits >> lane & 1) {
            wide_split_add(o, x, n, lane, f->gamma);
        } else {
            r[0] = run_of(o, 0, f, n, lane, f->finer >> lane & 1, room[0]);
            wide_margin_add(o, x, &r[0]);
        }
    }
    if ((fit[0].far | fit[1].far) >> lane & 1) {
        double gamma[OVERLAP_AXES][OVERLAP_NODES];
        for (uint32_t x = 0; x < OVERLAP_AXES; x++)
            for (int i = 0; i < OVERLAP_NODES; i++)
                gamma[x][i] = (double)fit[x].gamma[i][lane];
        overlap_add_joint(&o->scalar, t, gamma);
    } else {
        for (uint32_t x = 0; x < OVERLAP_AXES; x++)
            r[x] = run_of(o, x, &fit[x], n, lane, true, room[x]);
        for (uint32_t x = 0; x < OVERLAP_AXES; x++)
            overlap_touch(&o->scalar, x, r[x].first, r[x].first + r[x].count);
        find_products(o, &r[0], &r[1], NULL, add_joint);
    }
    overlap_finish_joint(&o->scalar, light);
}

void wide_overlap_add(struct wide_overlap *o, const struct wide_fit fit[OVERLAP_AXES],
                      const struct wide_nodes *n, uint32_t lane, const struct overlap_triangle *t,
                      const double light[OVERLAP_CHANNELS]) {
    const uint32_t axes = o->scalar.axes;
    const uint32_t splits = (axes > 0 ? fit[0].splits : 0) | (axes > 1 ? fit[1].splits : 0);
    const uint32_t finer = (axes > 0 ? fit[0].finer : 0) | (axes > 1 ? fit[1].finer : 0);
    const struct lit l = lit_of(light);
    struct part room[OVERLAP_AXES][FIT_FINE];
    struct part_run r[OVERLAP_AXES];
    if (splits >> lane & 1) {
        o->scalar.tolerance = (double)n->tolerance[lane];
        if (axes == 1)
            add_split(o, fit, n, lane, light);
        else
            add_fitted(o, fit, n, lane, t, light);
        return;
    }
    for (uint32_t x = 0; x < axes; x++)
        r[x] = run_of(o, x, &fit[x], n, lane, finer >> lane & 1, room[x]);
    if (axes == 0)
        for (int c = 0; c < OVERLAP_CHANNELS; c++)
            o->scalar.sums[c] += light[c];
    else if (axes == 1)
        add_vector(o, &r[0], &l);
    else
        find_products(o, &r[0], &r[1], &l, add_lit);
}
