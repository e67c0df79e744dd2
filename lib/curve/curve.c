// SPDX-License-Identifier: Apache-2.0
#include "curve/curve.h"

#include <assert.h>
#include <math.h>
#include <string.h>

struct curve curve_make(struct arena *arena, const struct basis *basis, uint32_t channels) {
    assert(channels == 1 || channels == CURVE_CHANNELS);
    struct curve c = {*basis, channels, NULL};
    c.values = arena_alloc(arena, sizeof *c.values * channels * basis->count);
    return c;
}

// ---- projection -----------------------------------------------------------------------------

struct projection {
    struct curve *curve;
    curve_fn f;
    const void *ctx;
    enum curve_filter filter;
    double *top, *bottom; // integrals of f b w and of b w
};

// One node of the quadrature, of weight q, inside an interval.
static void add_node(const struct projection *p, uint32_t interval, double gamma, double q) {
    const struct basis *b = &p->curve->basis;
    const double w = q * (p->filter == FILTER_SINE ? sin(gamma) : 1);
    const double f = p->f(p->ctx, gamma);
    if (b->kind == BASIS_BOX) {
        p->top[interval] += w * f;
        p->bottom[interval] += w;
        return;
    }
    const double *k = b->knots + interval;
    const double t = (gamma - k[0]) / (k[1] - k[0]);
    p->top[interval] += w * (1 - t) * f;
    p->bottom[interval] += w * (1 - t);
    p->top[interval + 1] += w * t * f;
    p->bottom[interval + 1] += w * t;
}

// Gauss-Legendre, 6 points: exact to degree 11.
static void add_piece(const struct projection *p, uint32_t interval, double lo, double hi) {
    static const double x[3] = {0.2386191860831969, 0.6612093864662645, 0.9324695142031521};
    static const double w[3] = {0.4679139345726910, 0.3607615730481386, 0.1713244923791704};
    const double middle = 0.5 * (lo + hi), half = 0.5 * (hi - lo);
    for (int i = 0; i < 3; i++) {
        add_node(p, interval, middle - half * x[i], half * w[i]);
        add_node(p, interval, middle + half * x[i], half * w[i]);
    }
}

// Pieces that halve towards both ends, where lobes peak and curves bend.
static void add_graded(const struct projection *p, uint32_t interval, double lo, double hi) {
    const double middle = 0.5 * (lo + hi);
    double step = middle - lo;
    while (step > 1e-5) {
        add_piece(p, interval, lo + 0.5 * step, lo + step);
        add_piece(p, interval, hi - step, hi - 0.5 * step);
        step *= 0.5;
    }
    add_piece(p, interval, lo, lo + step);
    add_piece(p, interval, hi - step, hi);
}

static void add_interval(const struct projection *p, uint32_t interval, const double *breaks,
                         uint32_t count) {
    double lo = p->curve->basis.knots[interval];
    const double hi = p->curve->basis.knots[interval + 1];
    for (uint32_t i = 0; i < count && breaks[i] < hi; i++)
        if (breaks[i] > lo) {
            add_graded(p, interval, lo, breaks[i]);
            lo = breaks[i];
        }
    add_graded(p, interval, lo, hi);
}

static double point_of(const struct basis *b, uint32_t j) {
    return b->kind == BASIS_HAT ? b->knots[j] : 0.5 * (b->knots[j] + b->knots[j + 1]);
}

void curve_project(struct curve *c, uint32_t channel, curve_fn f, const void *ctx,
                   enum curve_filter filter, const double *breaks, uint32_t break_count) {
    const uint32_t n = c->basis.count;
    double *values = c->values + (size_t)channel * n;
    if (filter == FILTER_POINT) {
        for (uint32_t j = 0; j < n; j++)
            values[j] = fmax(f(ctx, point_of(&c->basis, j)), 0);
        return;
    }
    double *top = mem_array(2 * (size_t)n, sizeof *top);
    const struct projection p = {c, f, ctx, filter, top, top + n};
    uint32_t first = 0; // break that may lie in the interval
    for (uint32_t i = 0; i < basis_intervals(&c->basis); i++) {
        while (first < break_count && breaks[first] <= c->basis.knots[i])
            first++;
        add_interval(&p, i, breaks + first, break_count - first);
    }
    for (uint32_t j = 0; j < n; j++)
        values[j] = fmax(p.top[j] / p.bottom[j], 0);
    mem_free(top);
}

double curve_channel_at(const void *ctx, double gamma) {
    const struct curve_channel *c = ctx;
    return curve_at(c->curve, c->index, gamma);
}

void curve_resample(struct curve *c, const struct curve *from, enum curve_filter filter) {
    for (uint32_t k = 0; k < c->channels; k++) {
        const struct curve_channel source = {from, k};
        if (basis_equal(&c->basis, &from->basis))
            memcpy(c->values + (size_t)k * c->basis.count, curve_values(from, k),
                   sizeof *c->values * c->basis.count);
        else
            curve_project(c, k, curve_channel_at, &source, filter, from->basis.knots,
                          basis_knots(&from->basis));
    }
}

double curve_at(const struct curve *c, uint32_t channel, double gamma) {
    uint32_t index[2];
    double value[2], sum = 0;
    const double *v = curve_values(c, channel);
    for (uint32_t i = 0, n = basis_at(&c->basis, gamma, index, value); i < n; i++)
        sum += value[i] * v[index[i]];
    return sum;
}
