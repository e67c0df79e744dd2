// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_strategy.h"

// ---- intervals ------------------------------------------------------------------------------

// The last of n intervals that does not begin beyond x.
static wide_long bisect(const double *edges, int64_t n, wide_double x) {
    wide_long low = {0}, high = low + n;
    for (int64_t left = n; left > 1; left -= left / 2) {
        const wide_long middle = low + (high - low) / 2;
        const wide_long up = wide_double_gather(edges, middle) <= x;
        low = (middle & up) | (low & ~up);
        high = (high & up) | (middle & ~up);
    }
    return low;
}

// At most n - 1, and 0 for what is no number.
static wide_long whole(wide_double place, int64_t n) {
    const wide_double some = wide_double_max(place, wide_double_of(0));
    return __builtin_convertvector(wide_double_min(some, wide_double_of((double)(n - 1))), wide_long);
}

wide_long half_interval(const struct basis *b, wide_double gamma) {
    const int64_t n = basis_intervals(b);
    if (b->spacing == SPACING_ANY)
        return bisect(b->knots, n, gamma);
    const wide_double x = gamma * (1 / CURVE_END);
    const double all = (double)n;
    wide_long i = whole(all * (b->spacing == SPACING_UNIFORM ? x : wide_double_sqrt(x)), n), off;
    while (wide_long_bits(off = (i > 0) & (gamma < wide_double_gather(b->knots, i))))
        i += off;
    while (wide_long_bits(off = (i + 1 < n) & (gamma >= wide_double_gather(b->knots + 1, i))))
        i -= off;
    return i;
}

// ---- strategies -----------------------------------------------------------------------------

static bool fits(const struct curve_strategy *c) {
    const struct curve_marginal *m = &c->first;
    switch (c->kind) {
    case STRATEGY_COSINE: return true;
    case STRATEGY_POLAR:
        return m->basis && m->level && m->gamma.kind == GAMMA_THETA_H && !c->second.basis;
    case STRATEGY_MIRROR:
    case STRATEGY_DIFFERENCE: return m->basis && m->level && half_gamma_fits(m->gamma.kind);
    default: return false;
    }
}

bool wide_strategy_fits(const struct bin_sampler *s) {
    for (uint32_t i = 0; i < s->count; i++)
        if (!fits(&s->strategy[i]))
            return false;
    return s->count <= WIDE_STRATEGIES;
}

// curve_marginal_cdf of a level one
static wide_double cdf_at(const struct curve_marginal *m, wide_double x) {
    const wide_long i = bisect(m->edges, basis_intervals(m->basis), x);
    const wide_double start = wide_double_gather(m->edges, i);
    const wide_double width = wide_double_gather(m->edges + 1, i) - start, none = {0};
    const wide_double t = wide_double_select(width > 0, (x - start) / width, none);
    const wide_double part = wide_double_min(wide_double_max(t, none), none + 1);
    const wide_double ends = wide_double_gather(&m->ends[0][0], 2 * i);
    return wide_double_min(wide_double_gather(m->cdf, i) + ends * part * width, none + 1);
}

void wide_strategy_reach(const struct bin_sampler *s, struct half_directions wo,
                         wide_double reach[WIDE_STRATEGIES]) {
    const wide_double one = wide_double_of(1);
    const wide_double sine = wide_double_min(wide_double_sqrt(wo.x * wo.x + wo.y * wo.y), one);
    for (uint32_t i = 0; i < s->count; i++)
        reach[i] = s->strategy[i].kind == STRATEGY_POLAR
                       ? cdf_at(&s->strategy[i].first, 0.5 + 0.5 * sine)
                       : one;
}

static wide_double marginal_pdf(const struct curve_marginal *m, struct half_angles *a) {
    const wide_double gamma = half_gamma_at(m->gamma.kind, a), none = {0};
    const wide_long i = half_interval(m->basis, gamma);
    return wide_double_select(gamma > CURVE_END * (1 + 1e-12), none,
                              wide_double_gather(&m->ends[0][0], 2 * i));
}

static wide_double polar_pdf(const struct curve_strategy *c, struct half_angles *a) {
    const wide_double none = {0}, inv = 1 / a->length, cos_h = (a->wi.z + a->wo.z) * inv;
    const wide_double p = marginal_pdf(&c->first, a) * (1 / CURVE_END), h = p * 0.5 * a->cos_h;
    const wide_double pdf = wide_double_min(0.5 * h / (0.5 * a->length),
                                            0.25 * h / (cos_h * a->wo.z));
    return wide_double_select(a->length > 0, pdf, none);
}

static wide_double strategy_pdf(const struct curve_strategy *c, struct half_angles *a) {
    switch (c->kind) {
    case STRATEGY_COSINE: return a->wi.z / M_PI;
    case STRATEGY_POLAR: return polar_pdf(c, a);
    default: return marginal_pdf(&c->first, a) / (4 * M_PI);
    }
}

wide_double wide_strategy_pdf_sa(const struct bin_sampler *s,
                                 const wide_double reach[WIDE_STRATEGIES], struct half_angles *a) {
    wide_double sum = {0};
    for (uint32_t i = 0; i < s->count; i++)
        sum += s->strategy[i].share * strategy_pdf(&s->strategy[i], a) / reach[i];
    return sum;
}

// ---- samples --------------------------------------------------------------------------------

static wide_double level_sample(const struct curve_marginal *m, wide_double u) {
    const int64_t n = basis_intervals(m->basis);
    const double all = (double)n;
    const wide_double place = u * all;
    const wide_long i = whole(place, n);
    const wide_double t = wide_double_min(place - __builtin_convertvector(i, wide_double),
                                          wide_double_of(1));
    const wide_double start = wide_double_gather(m->edges, i);
    return start + t * (wide_double_gather(m->edges + 1, i) - start);
}

static wide_double take_sign(wide_double *u) {
    const wide_long low = *u < 0.5;
    *u = wide_double_select(low, 2 * *u, 2 * *u - 1);
    return wide_double_select(low, wide_double_of(-1), wide_double_of(1));
}

// An azimuth: its sine and cosine, of the library.
struct azimuth {
    wide_double sine, cosine;
};

static struct azimuth azimuth_of(wide_double phi) {
    struct azimuth a = {{0}, {0}};
    for (int i = 0; i < WIDE_HALF; i++) {
        a.sine[i] = sin(phi[i]);
        a.cosine[i] = cos(phi[i]);
    }
    return a;
}

static struct half_directions around_normal(wide_double x, struct azimuth phi) {
    const wide_double s = wide_double_sqrt(x);
    return (struct half_directions){s * phi.cosine, s * phi.sine, wide_double_sqrt(1 - x)};
}

static wide_double half_dot(struct half_directions a, struct half_directions b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct half_directions half_select(wide_long m, struct half_directions a, struct half_directions b) {
    return (struct half_directions){wide_double_select(m, a.x, b.x), wide_double_select(m, a.y, b.y),
                                wide_double_select(m, a.z, b.z)};
}

// The half vector's quarter turn, and the signs that make it whole.
struct quarter {
    wide_double phi, x, y;
};

static struct quarter quarter_of(wide_double v) {
    struct quarter q;
    q.x = take_sign(&v);
    q.y = take_sign(&v);
    q.phi = v * CURVE_END;
    return q;
}

static struct half_directions polar_sample(const struct curve_strategy *s, struct half_directions wo,
                                       wide_double left, wide_double u, wide_double v,
                                       struct azimuth phi) {
    const struct quarter q = quarter_of(v);
    const wide_double none = {0};
    struct half_directions h = around_normal(level_sample(&s->first, u), phi);
    h.x = q.x * h.x;
    h.y = q.y * h.y;
    const struct half_directions other = {-h.x, -h.y, h.z};
    const wide_double c = wide_double_max(half_dot(wo, h), none);
    const wide_double c1 = wide_double_max(half_dot(wo, other), none);
    h = half_select(left * (c + c1) < c, h, other);
    const wide_double twice = 2 * half_dot(wo, h);
    return (struct half_directions){twice * h.x - wo.x, twice * h.y - wo.y, twice * h.z - wo.z};
}

// direction_around, x = sin^2 of half the angle.
static struct half_directions around(struct half_directions axis, wide_double x, struct azimuth phi) {
    const wide_double cos_a = 1 - 2 * x, sin_a = 2 * wide_double_sqrt(x * (1 - x));
    const wide_double sign = wide_double_copysign(wide_double_of(1), axis.z);
    const wide_double a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
    const wide_double s = sin_a * phi.cosine, t = sin_a * phi.sine;
    return (struct half_directions){s * (1 + sign * axis.x * axis.x * a) + t * b + cos_a * axis.x,
                                s * sign * b + t * (sign + axis.y * axis.y * a) + cos_a * axis.y,
                                -s * sign * axis.x - t * axis.y + cos_a * axis.z};
}

static struct half_directions strategy_sample(const struct curve_strategy *c, struct half_directions wo,
                                          wide_double left, wide_double u, wide_double v,
                                          struct azimuth phi) {
    const struct half_directions mirror = {-wo.x, -wo.y, wo.z};
    switch (c->kind) {
    case STRATEGY_COSINE: return around_normal(u, phi);
    case STRATEGY_POLAR: return polar_sample(c, wo, left, u, v, phi);
    case STRATEGY_MIRROR: return around(mirror, level_sample(&c->first, u), phi);
    default: return around(wo, level_sample(&c->first, u), phi);
    }
}

// The lanes of each strategy, and u1 without the shares of those before it.
static void choose_strategies(const struct bin_sampler *s, wide_double u1,
                              wide_long here[WIDE_STRATEGIES], wide_double rest[WIDE_STRATEGIES]) {
    wide_long waiting = ~(wide_long){0};
    for (uint32_t i = 0; i < s->count; i++) {
        const double share = s->strategy[i].share;
        here[i] = i + 1 < s->count ? waiting & (u1 < share) : waiting;
        rest[i] = wide_double_min(u1 / share, wide_double_of(1 - 0x1p-53));
        waiting &= ~here[i];
        u1 -= share;
    }
}

struct half_directions wide_strategy_sample(const struct bin_sampler *s,
                                        const wide_double reach[WIDE_STRATEGIES],
                                        struct half_directions wo, wide_double left, wide_double u1,
                                        wide_double u2) {
    struct half_directions wi = wo;
    wide_long here[WIDE_STRATEGIES];
    wide_double rest[WIDE_STRATEGIES], phi = 2 * M_PI * u2;
    choose_strategies(s, u1, here, rest);
    for (uint32_t i = 0; i < s->count; i++)
        if (s->strategy[i].kind == STRATEGY_POLAR)
            phi = wide_double_select(here[i], quarter_of(u2).phi, phi);
    const struct azimuth azimuth = azimuth_of(phi); // the dearest of all: once
    for (uint32_t i = 0; i < s->count; i++)
        if (wide_long_bits(here[i]))
            wi = half_select(here[i], strategy_sample(&s->strategy[i], wo, left, rest[i] * reach[i], u2,
                                                  azimuth), wi);
    return wi;
}
