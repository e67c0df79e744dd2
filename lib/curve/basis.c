// SPDX-License-Identifier: Apache-2.0
#include "curve/basis.h"

#include <assert.h>
#include <math.h>

struct basis basis_make(struct arena *arena, enum basis_kind kind, uint32_t count,
                        enum basis_spacing spacing) {
    assert(count >= (kind == BASIS_BOX ? 1 : 2) && count <= BASIS_MOST && spacing != SPACING_ANY);
    struct basis b = {kind, spacing, count, NULL};
    const uint32_t intervals = basis_intervals(&b);
    double *knots = arena_alloc(arena, sizeof *knots * (intervals + 1));
    for (uint32_t i = 0; i <= intervals; i++) {
        const double t = (double)i / intervals;
        knots[i] = CURVE_END * (spacing == SPACING_UNIFORM ? t : t * t);
    }
    b.knots = knots;
    return b;
}

bool basis_equal(const struct basis *a, const struct basis *b) {
    if (a->kind != b->kind || a->count != b->count)
        return false;
    for (uint32_t i = 0; i < basis_knots(a); i++)
        if (a->knots[i] != b->knots[i])
            return false;
    return true;
}

static uint32_t guess(const struct basis *b, double gamma) {
    const uint32_t n = basis_intervals(b);
    const double x = gamma * (1 / CURVE_END);
    const double place = n * (b->spacing == SPACING_UNIFORM ? x : sqrt(x));
    return place < n ? (uint32_t)place : n - 1;
}

static uint32_t bisect(const struct basis *b, double gamma) {
    uint32_t lo = 0, hi = basis_intervals(b); // invariant: knots[lo] <= gamma, hi is beyond
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (b->knots[middle] <= gamma)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

uint32_t basis_interval(const struct basis *b, double gamma) {
    uint32_t i = b->spacing == SPACING_ANY ? bisect(b, gamma) : guess(b, gamma);
    while (i > 0 && gamma < b->knots[i])
        i--;
    while (i + 1 < basis_intervals(b) && gamma >= b->knots[i + 1])
        i++;
    return i;
}

double basis_place(const struct basis *b, uint32_t i, double gamma) {
    const double x = (gamma - b->knots[i]) / (b->knots[i + 1] - b->knots[i]);
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

uint32_t basis_at(const struct basis *b, double gamma, uint32_t index[2], double value[2]) {
    if (!(gamma >= 0 && gamma <= b->knots[basis_intervals(b)] * (1 + 1e-6)))
        return 0;
    const uint32_t i = basis_interval(b, gamma);
    index[0] = i;
    value[0] = 1;
    if (b->kind == BASIS_BOX)
        return 1;
    index[1] = i + 1;
    value[1] = basis_place(b, i, gamma);
    value[0] = 1 - value[1];
    return 2;
}

double basis_exponent(const struct basis *b) {
    const uint32_t n = basis_intervals(b);
    const double bins = 5.2 / CURVE_END * n / b->count; // of the spread; count, also where hats are more
    const uint32_t i = bins < n ? (uint32_t)bins : n - 1;
    const double spread = b->knots[i] + (bins - i) * (b->knots[i + 1] - b->knots[i]);
    return 1 / (spread * spread);
}
