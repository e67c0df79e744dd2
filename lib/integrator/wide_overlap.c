// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_overlap.h"

#include "math/wide.h"

enum { MOST = 48 }; // functions that a triangle may touch here

// Bend of gamma, relative to its range, up to which a quadratic will do.
static const float MOST_BEND = 0.12f;

static const float THIN = 1e-7f; // radians: no part is thinner

// Barycentric coordinates of corners 1 and 2 at the corners of the parts of the parts.
static const wide b1[3] = {
    {0, 0.5, 0, 0.25, 1, 0.5, 0.5, 0.75, 0, 0, 0.5, 0, 0.5, 0.5, 0, 0.5},
    {0.25, 0.25, 0, 0.25, 0.75, 0.5, 0.75, 0.5, 0, 0.25, 0.25, 0.25, 0.5, 0.25, 0.25, 0.25},
    {0, 0.25, 0.25, 0, 0.75, 0.75, 0.5, 0.75, 0.25, 0, 0.25, 0.25, 0.25, 0.5, 0.25, 0.25},
};
static const wide b2[3] = {
    {0, 0, 0.5, 0, 0, 0.5, 0, 0.25, 1, 0.5, 0.5, 0.75, 0, 0.5, 0.5, 0.25},
    {0, 0.25, 0.25, 0.25, 0.25, 0.25, 0, 0.25, 0.75, 0.5, 0.75, 0.5, 0.25, 0.5, 0.25, 0.5},
    {0.25, 0, 0.25, 0.25, 0, 0.25, 0.25, 0, 0.75, 0.75, 0.5, 0.75, 0.25, 0.25, 0.5, 0.25},
};

// The shares of each part in the functions from `first` on.
struct shares {
    uint32_t first, count;
    wide share[MOST];
};

// Gammas of the parts in order, and what of the triangle each is.
struct slopes {
    wide g0, g1, g2, rise, fall, part;
};

static struct slopes slopes_of(wide a, wide b, wide c, wide part) {
    const wide low = wide_min(a, b), high = wide_max(a, b);
    const wide g0 = wide_min(low, c), g2 = wide_max(wide_max(high, c), g0 + THIN);
    const wide g1 = wide_max(low, wide_min(high, c)), none = wide_of(1e-12f);
    const wide width = g2 - g0;
    return (struct slopes){g0, g1, g2, 1 / (wide_max(g1 - g0, none) * width),
                           1 / (wide_max(g2 - g1, none) * width), part};
}

// Share of the area below t.
static inline wide below(const struct slopes *s, wide t) {
    const wide r = wide_min(wide_max(t, s->g0), s->g1) - s->g0;
    const wide f = s->g2 - wide_min(wide_max(t, s->g1), s->g2), d = s->g2 - s->g1;
    return r * r * s->rise + (d * d - f * f) * s->fall;
}

// Its integral up to t.
static inline wide integral_below(const struct slopes *s, wide t) {
    const wide r = wide_min(wide_max(t, s->g0), s->g1) - s->g0;
    const wide c = wide_min(wide_max(t, s->g1), s->g2), f = s->g2 - c, d = s->g2 - s->g1;
    return r * r * r * s->rise * (1.0f / 3) + (c - s->g1) -
           s->fall * (d * d * d - f * f * f) * (1.0f / 3) + wide_max(t - s->g2, wide_of(0));
}

// Adds the shares in functions from out->first to the interval `last`, which takes what lies beyond.
static void add_boxes(const struct overlap_axis *a, const struct slopes *s, uint32_t last, bool from_0,
                      struct shares *out) {
    const double *k = a->basis.knots;
    const bool ends = a->gamma.kind == GAMMA_THETA_R && last + 1 == basis_intervals(&a->basis);
    // Nothing lies below the first edge but rounding.
    wide F = from_0 ? below(s, wide_of((float)k[out->first])) : wide_of(0);
    for (uint32_t i = out->first; i <= last; i++) {
        const wide F1 = i < last || ends ? below(s, wide_of((float)k[i + 1])) : wide_of(1);
        out->share[i - out->first] += s->part * (F1 - F);
        F = F1;
    }
}

static void add_hats(const struct overlap_axis *a, const struct slopes *s, uint32_t last, bool from_0,
                     struct shares *out) {
    const double *k = a->basis.knots;
    const bool ends = a->gamma.kind == GAMMA_THETA_R && last + 1 == basis_intervals(&a->basis);
    const wide start = wide_of((float)k[out->first]), none = wide_of(0);
    wide F = from_0 ? below(s, start) : none, I = integral_below(s, start);
    for (uint32_t i = out->first; i <= last; i++) {
        const wide end = wide_of((float)k[i + 1]);
        const wide F1 = below(s, end), I1 = integral_below(s, end);
        const wide mean = (I1 - I) * (float)(1 / (k[i + 1] - k[i]));
        const wide beyond = i == last && !ends ? 1 - F1 : none;
        wide *share = &out->share[i - out->first];
        share[0] += s->part * wide_max(mean - F, none);
        share[1] += s->part * (wide_max(F1 - mean, none) + beyond);
        F = F1;
        I = I1;
    }
}

static void add_upper(const struct overlap_axis *a, const struct slopes *s, uint32_t last, bool from_0,
                      struct shares *out) {
    if (a->basis.kind == BASIS_HAT)
        add_hats(a, s, last, from_0, out);
    else
        add_boxes(a, s, last, from_0, out);
}

// The quadratic through the nodes at the corners of all parts.
static void interpolate(const float g[OVERLAP_NODES], wide out[3]) {
    const float c3 = 2 * (g[1] + g[0]) - 4 * g[3], c5 = 2 * (g[2] + g[0]) - 4 * g[5];
    const float c1 = g[1] - g[0] - c3, c2 = g[2] - g[0] - c5;
    const float c4 = 4 * (g[4] - g[0] - 0.5f * (c1 + c2)) - c3 - c5;
    for (int i = 0; i < 3; i++)
        out[i] = g[0] + b1[i] * (c1 + c3 * b1[i] + c4 * b2[i]) + b2[i] * (c2 + c5 * b2[i]);
}

// false: the scalar way.
static bool deal(const struct overlap_axis *a, const double gamma[OVERLAP_NODES], wide part,
                 struct shares *out) {
    float g[OVERLAP_NODES], least, most, bend = 0;
    const float sign = gamma[0] + gamma[1] + gamma[2] < 0 ? -1 : 1; // so that most of it is positive
    for (int i = 0; i < OVERLAP_NODES; i++)
        g[i] = sign * (float)gamma[i];
    least = most = g[0];
    for (int i = 1; i < OVERLAP_NODES; i++) {
        least = minf(least, g[i]);
        most = maxf(most, g[i]);
    }
    for (int i = 0; i < 3; i++)
        bend = maxf(bend, fabsf(g[3 + i] - 0.5f * (g[i] + g[(i + 1) % 3])));
    if (bend > MOST_BEND * (most - least))
        return false;
    const bool straddles = least < 0;
    const uint32_t last = overlap_interval(a, (double)maxf(most + 0.25f * bend, -least));
    out->first = straddles ? 0 : overlap_interval(a, (double)(least - 0.25f * bend));
    out->count = last - out->first + 1 + (a->basis.kind == BASIS_HAT);
    if (out->count > MOST)
        return false;
    wide c[3];
    interpolate(g, c);
    for (uint32_t i = 0; i < out->count; i++)
        out->share[i] = wide_of(0);
    const struct slopes s = slopes_of(c[0], c[1], c[2], part);
    add_upper(a, &s, last, straddles, out);
    if (straddles) {
        const struct slopes m = slopes_of(-c[0], -c[1], -c[2], part);
        add_upper(a, &m, last, true, out);
    }
    return true;
}

static float sum_of(wide a) {
#if defined(__AVX512F__)
    return _mm512_reduce_add_ps((__m512)a);
#else
    float sum = 0;
    for (int i = 0; i < WIDE_LANES; i++)
        sum += a[i];
    return sum;
#endif
}

static void add_one(double *sum, const double light[OVERLAP_CHANNELS], double share) {
    for (int c = 0; c < OVERLAP_CHANNELS; c++)
        sum[c] += light[c] * share;
}

// Both curves, where one of them bends too much: each alone as with one curve.
static void add_fitted(struct overlap *o, const struct overlap_triangle *t,
                       double gamma[OVERLAP_AXES][OVERLAP_NODES], wide part,
                       const double light[OVERLAP_CHANNELS]) {
    for (uint32_t x = 0; x < OVERLAP_AXES; x++) {
        struct shares s;
        if (!deal(&o->axis[x], gamma[x], part, &s)) {
            overlap_add_alone(o, x, t, gamma);
            continue;
        }
        for (uint32_t i = 0; i < s.count; i++)
            o->margin[x][s.first + i] = (double)sum_of(s.share[i]);
        overlap_touch(o, x, s.first, s.first + s.count);
    }
    overlap_add_fitted(o, t, gamma, light);
}

void wide_overlap_add(struct overlap *o, const struct overlap_triangle *t,
                      double gamma[OVERLAP_AXES][OVERLAP_NODES],
                      const double light[OVERLAP_CHANNELS]) {
    struct shares a, b;
    wide part;
    for (int i = 0; i < WIDE_LANES; i++)
        part[i] = (float)(0.25 * t->part[i / 4]);
    if (o->axes == 0) {
        add_one(o->sums, light, 1);
        return;
    }
    if (!deal(&o->axis[0], gamma[0], part, &a) ||
        (o->axes > 1 && !deal(&o->axis[1], gamma[1], wide_of(1), &b))) {
        if (o->axes > 1)
            add_fitted(o, t, gamma, part, light);
        else
            overlap_add(o, t, gamma, light);
        return;
    }
    for (uint32_t j = 0; j < a.count && o->axes == 1; j++)
        add_one(o->sums + (a.first + j) * OVERLAP_CHANNELS, light, (double)sum_of(a.share[j]));
    for (uint32_t j = 0; j < a.count && o->axes > 1; j++)
        for (uint32_t k = 0; k < b.count; k++)
            add_one(o->sums + ((size_t)(a.first + j) * o->axis[1].basis.count + b.first + k) *
                                  OVERLAP_CHANNELS,
                    light, (double)sum_of(a.share[j] * b.share[k]));
}
