// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_part.h"

static const float THIN = 3e-7f; // radians: no part is thinner

void wide_axis_init(struct wide_axis *a, const struct overlap_axis *of, struct arena *arena) {
    const struct basis *b = &of->basis;
    const uint32_t n = basis_intervals(b), room = n + 1 + 2 * WIDE_LANES;
    *a = (struct wide_axis){of, b->kind == BASIS_HAT, (float)of->per_step, 0, INFINITY, NULL, NULL};
    a->edges = arena_alloc(arena, room * sizeof *a->edges);
    a->inverse = arena_alloc(arena, room * sizeof *a->inverse);
    for (uint32_t i = 0; i < room; i++) {
        a->edges[i] = (float)b->knots[i < n ? i : n];
        a->inverse[i] = i < n ? (float)(1 / (b->knots[i + 1] - b->knots[i])) : 0;
    }
    if (of->per_step > 0)
        a->step = (float)(1 / of->per_step);
    if (of->gamma.kind == GAMMA_THETA_R)
        a->end = (float)b->knots[n];
}

// Share of the area of a part below t.
static inline wide below(wide g0, wide g1, wide g2, wide rise, wide fall, wide top, wide t) {
    const wide r = wide_min(wide_max(t, g0), g1) - g0, f = g2 - wide_min(wide_max(t, g1), g2);
    return r * r * rise + (top - f * f * fall);
}

static inline wide part_below(const struct part *p, wide t) {
    return below(wide_of(p->g0), wide_of(p->g1), wide_of(p->g2), wide_of(p->rise), wide_of(p->fall),
                 wide_of(p->top), t);
}

// Its integral up to t.
static inline wide integral_below(const struct part *p, wide t) {
    const float d = p->g2 - p->g1;
    const wide r = wide_min(wide_max(t, wide_of(p->g0)), wide_of(p->g1)) - p->g0;
    const wide c = wide_min(wide_max(t, wide_of(p->g1)), wide_of(p->g2)), f = p->g2 - c;
    return (r * r * r * p->rise + f * f * f * p->fall - p->top * d) * (1.0f / 3) + (c - p->g1) +
           wide_max(t - p->g2, wide_of(0));
}

void parts_store(const struct wide_axis *a, wide ga, wide gb, wide gc, wide weight,
                 struct part *const to[WIDE_LANES]) {
    const wide low = wide_min(ga, gb), high = wide_max(ga, gb), none = wide_of(1e-12f);
    const wide g0 = wide_min(low, gc), g2 = wide_max(wide_max(high, gc), g0 + THIN);
    const wide g1 = wide_max(low, wide_min(high, gc)), width = g2 - g0, d = g2 - g1;
    const wide rise = 1 / (wide_max(g1 - g0, none) * width), fall = 1 / (wide_max(d, none) * width);
    const wide top = d * d * fall;
    const wide inside = weight * below(g0, g1, g2, rise, fall, top, wide_of(a->end));
    float *row[WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = &to[i]->g0;
    wide_scatter4((wide[4]){g0, g1, g2, rise}, row);
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = &to[i]->fall;
    wide_scatter4((wide[4]){fall, top, weight, inside}, row);
}

// What lies up to the upper ends of boxes.
static wide up_to_boxes(const struct wide_axis *a, const struct part_run *r, uint32_t at) {
    const wide t = wide_load(a->edges + r->first + at + 1);
    wide sum = {0};
    for (uint32_t i = 0; i < r->parts; i++)
        sum += r->part[i].weight * part_below(&r->part[i], t);
    for (uint32_t i = 0; i < r->parts && r->straddles; i++)
        sum -= r->part[i].weight * part_below(&r->part[i], -t);
    return sum;
}

// Numbers that should ascend, but for rounding: each the largest so far.
static wide ascending(wide a) {
    for (int step = 1; step < WIDE_LANES; step *= 2)
        a = wide_max(a, wide_before(a, step));
    return a;
}

// Likewise of hats, but for the last lane.
static wide up_to_hats(const struct wide_axis *a, const struct part_run *r, uint32_t at) {
    const wide t = wide_load(a->edges + r->first + at);
    wide sum = {0};
    for (uint32_t i = 0; i < r->parts; i++)
        sum += r->part[i].weight * integral_below(&r->part[i], t);
    for (uint32_t i = 0; i < r->parts && r->straddles; i++)
        sum += r->part[i].weight * integral_below(&r->part[i], -t);
    return (wide_next(sum) - sum) * wide_load(a->inverse + r->first + at);
}

wide part_shares(const struct wide_axis *a, const struct part_run *r, uint32_t at, float *done) {
    const wide_int lane = {WIDE_LOWER, WIDE_UPPER};
    float all = 0;
    for (uint32_t i = 0; i < r->parts; i++)
        all += r->part[i].inside;
    wide up = r->count == 1 ? wide_of(all) : a->hat ? up_to_hats(a, r, at) : up_to_boxes(a, r, at);
    up = wide_max(wide_min(up, wide_of(all)), wide_of(*done));
    wide_mask last = lane + (int32_t)at >= (int32_t)r->count - 1;
    if (a->hat) { // the last lane is not known: nothing in it
        up = ascending(wide_select(lane == WIDE_LANES - 1, wide_of(*done), up));
        last &= lane != WIDE_LANES - 1;
    }
    up = wide_select(last, wide_of(all), up);
    wide before = wide_before(up, 1);
    before[0] = *done;
    *done = up[WIDE_LANES - 2 + !a->hat];
    return wide_max(up - before, wide_of(0));
}
