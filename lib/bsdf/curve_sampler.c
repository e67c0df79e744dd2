// SPDX-License-Identifier: Apache-2.0
#include "bsdf/curve_sampler.h"

#include "math/half_vector.h"
#include "math/microfacet.h"

// ---- marginals ------------------------------------------------------------------------------

static double sqr_d(double x) {
    return x * x;
}

// The coordinate x at a knot.
static double coordinate(enum curve_strategy_kind kind, enum gamma_kind gamma, double knot) {
    switch (kind) {
    case STRATEGY_POLAR: return gamma == GAMMA_PHI_H ? knot : sqr_d(sin(knot));
    case STRATEGY_LIGHT: return sqr_d(sin(knot));
    case STRATEGY_MIRROR: return sqr_d(sin(0.5 * knot));
    case STRATEGY_DIFFERENCE: return sqr_d(sin(knot));
    default: return knot;
    }
}

// Where gamma cuts the plane (x, y) = sqrt(-2 log cos_h) (cos phi_h, sin phi_h) of STRATEGY_POWER.
static double plane_coordinate(const struct gamma *g, double gamma) {
    if (gamma >= CURVE_END)
        return HUGE_VAL;
    if (g->kind == GAMMA_RATIO)
        return tan(gamma) / sqrt(g->n);
    const double s = sin(gamma);
    return sqrt(-log1p(-s * s));
}

// d plane_coordinate / d gamma: tan(gamma) / x where gamma is the arc cosine of exp(-x^2 / 2);
// 1 / (sqrt(n) cos^2) where tan(gamma) = sqrt(n) x. 1 for other coordinates.
static double plane_slope(enum curve_strategy_kind kind, const struct gamma *g, double gamma) {
    const double t = tan(gamma);
    if (kind != STRATEGY_POWER)
        return 1;
    if (g->kind == GAMMA_RATIO)
        return (1 + t * t) / sqrt(g->n);
    return gamma > 1e-8 ? t / plane_coordinate(g, gamma) : 1;
}

// How light weighs gamma per unit of the coordinate: the plane's density of solid angle and the
// cosine of the half vector make exp(-(x^2 + y^2)); the other coordinates are made to weigh 1.
static double weight(enum curve_strategy_kind kind, const struct gamma *g, double gamma) {
    const double x = kind == STRATEGY_POWER ? plane_coordinate(g, gamma) : 0;
    return x < 20 ? exp(-x * x) * plane_slope(kind, g, gamma) : 0;
}

// Mean of the channels.
static double mean_value(const struct form *f, const struct form_slot *slot, double gamma) {
    double sum = 0;
    for (int k = 0; slot && k < CURVE_CHANNELS; k++)
        sum += function_value(&f->curve[slot->curve].f[k], gamma) / CURVE_CHANNELS;
    return slot ? sum : 1;
}

static const struct basis *even_basis(struct arena *arena) {
    struct basis *b = arena_alloc(arena, sizeof *b);
    *b = basis_make(arena, BASIS_BOX, 64, SPACING_UNIFORM);
    return b;
}

// Of the curve in a slot, or of a curve of 1 where slot is NULL.
static struct curve_marginal make_marginal(enum curve_strategy_kind kind, const struct form *f,
                                           const struct form_slot *slot, struct gamma gamma,
                                           struct arena *arena) {
    if (!slot && gamma.kind == GAMMA_PHI_H)
        return (struct curve_marginal){.gamma = gamma};
    const struct basis *b = slot ? &f->curve[slot->curve].f[0].table->basis : even_basis(arena);
    const uint32_t n = basis_intervals(b);
    double *cdf = arena_alloc(arena, sizeof *cdf * (n + 1));
    double *edges = arena_alloc(arena, sizeof *edges * (n + 1));
    double(*ends)[2] = arena_alloc(arena, sizeof *ends * n);
    edges[0] = coordinate(kind, gamma.kind, b->knots[0]);
    for (uint32_t i = 0; i < n; i++) {
        const double *k = b->knots + i, middle = 0.5 * (k[0] + k[1]);
        edges[i + 1] = coordinate(kind, gamma.kind, k[1]);
        for (int j = 0; j < 2; j++) {
            const double at = b->kind == BASIS_BOX ? middle : k[j];
            ends[i][j] = mean_value(f, slot, at) * weight(kind, &gamma, at);
        }
        cdf[i + 1] = cdf[i] + 0.5 * (ends[i][0] + ends[i][1]) * (edges[i + 1] - edges[i]);
    }
    const double total = cdf[n];
    for (uint32_t i = 0; i < n && total > 0; i++) {
        cdf[i + 1] = i + 1 < n ? cdf[i + 1] / total : 1;
        ends[i][0] /= total;
        ends[i][1] /= total;
    }
    return (struct curve_marginal){b, gamma, cdf, edges, (const double(*)[2])ends};
}

static bool is_empty(const struct curve_marginal *m) {
    return m->basis && !(m->cdf[basis_intervals(m->basis)] > 0);
}

// Density over x.
static double marginal_pdf(const struct curve_marginal *m, struct angles *a,
                           enum curve_strategy_kind kind) {
    if (!m->basis)
        return 1 / CURVE_END;
    const double gamma = gamma_at(&m->gamma, a);
    if (gamma > CURVE_END * (1 + 1e-12))
        return 0;
    const uint32_t i = basis_interval(m->basis, gamma);
    if (m->ends[i][0] == m->ends[i][1])
        return m->ends[i][0];
    const double x = coordinate(kind, m->gamma.kind, gamma);
    const double width = m->edges[i + 1] - m->edges[i];
    const double t = width > 0 ? fmin(fmax((x - m->edges[i]) / width, 0), 1) : 0;
    return m->ends[i][0] + t * (m->ends[i][1] - m->ends[i][0]);
}

static double level_sample(const struct curve_marginal *m, double u) {
    const uint32_t n = basis_intervals(m->basis);
    const double place = u * n;
    const uint32_t i = place < n ? (uint32_t)place : n - 1;
    return m->edges[i] + fmin(place - i, 1) * (m->edges[i + 1] - m->edges[i]);
}

static double marginal_sample(const struct curve_marginal *m, double u) {
    if (!m->basis)
        return u * CURVE_END;
    if (m->level)
        return level_sample(m, u);
    uint32_t lo = 0, hi = basis_intervals(m->basis); // invariant: cdf[lo] <= u < cdf[hi]
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (m->cdf[middle] <= u)
            lo = middle;
        else
            hi = middle;
    }
    // a linear density from a to b is inverted by the root of a square
    const double a = m->ends[lo][0], b = m->ends[lo][1];
    const double v = (u - m->cdf[lo]) / (m->cdf[lo + 1] - m->cdf[lo]);
    const double root = sqrt(fmax(a * a + v * (b * b - a * a), 0));
    const double t = a + root > 0 ? fmin(v * (a + b) / (a + root), 1) : 0;
    return m->edges[lo] + t * (m->edges[lo + 1] - m->edges[lo]);
}

double curve_marginal_cdf(const struct curve_marginal *m, double x) {
    uint32_t lo = 0, hi = basis_intervals(m->basis); // invariant: edges[lo] <= x, hi is beyond
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (m->edges[middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    const double width = m->edges[lo + 1] - m->edges[lo];
    const double t = width > 0 ? fmin(fmax((x - m->edges[lo]) / width, 0), 1) : 0;
    const double a = m->ends[lo][0], b = m->ends[lo][1];
    return fmin(m->cdf[lo] + (a + 0.5 * t * (b - a)) * t * width, 1);
}

void curve_marginal_level(struct curve_marginal *m, struct arena *arena) {
    const uint32_t n = basis_intervals(m->basis);
    double *cdf = arena_alloc(arena, sizeof *cdf * (n + 1));
    double(*ends)[2] = arena_alloc(arena, sizeof *ends * n);
    for (uint32_t i = 0; i < n; i++) {
        cdf[i + 1] = (i + 1.0) / n;
        ends[i][0] = ends[i][1] = 1 / (n * (m->edges[i + 1] - m->edges[i]));
    }
    m->cdf = cdf;
    m->ends = (const double(*)[2])ends;
    m->level = true;
}

// ---- strategies of a term -------------------------------------------------------------------

static enum curve_strategy_kind kind_of(enum gamma_kind g) {
    switch (g) {
    case GAMMA_THETA_H:
    case GAMMA_PHI_H: return STRATEGY_POLAR;
    case GAMMA_POWER_U:
    case GAMMA_POWER_V:
    case GAMMA_RATIO: return STRATEGY_POWER;
    case GAMMA_SLOPE_U:
    case GAMMA_SLOPE_V: return STRATEGY_SLOPE;
    case GAMMA_THETA_R: return STRATEGY_MIRROR;
    case GAMMA_THETA_D: return STRATEGY_DIFFERENCE;
    default: return STRATEGY_LIGHT;
    }
}

// Whether a gamma belongs to the second axis of a pair: phi_h, and all across the tangent.
static bool is_second(enum gamma_kind g) {
    return g == GAMMA_PHI_H || g == GAMMA_POWER_V || g == GAMMA_RATIO || g == GAMMA_SLOPE_V;
}

static bool is_pair(enum curve_strategy_kind kind) {
    return kind == STRATEGY_POLAR || kind == STRATEGY_POWER || kind == STRATEGY_SLOPE;
}

static enum gamma_kind axis_of(enum curve_strategy_kind kind, bool second) {
    switch (kind) {
    case STRATEGY_POLAR: return second ? GAMMA_PHI_H : GAMMA_THETA_H;
    case STRATEGY_POWER: return second ? GAMMA_POWER_V : GAMMA_POWER_U;
    default: return second ? GAMMA_SLOPE_V : GAMMA_SLOPE_U;
    }
}

// From the curves of the slots, either of which may be NULL but not both.
static void add_strategy(struct curve_sampler *s, enum curve_strategy_kind kind,
                         const struct form *f, const struct form_term *t,
                         const struct form_slot *first, const struct form_slot *second,
                         struct arena *arena) {
    struct curve_strategy *c = &s->strategy[s->count];
    const struct gamma along = first ? first->gamma : (struct gamma){axis_of(kind, false), 0};
    const struct gamma across = second ? second->gamma : (struct gamma){axis_of(kind, true), 0};
    c->kind = kind;
    c->first = make_marginal(kind, f, first, along, arena);
    if (!is_pair(kind)) {
        s->count += !is_empty(&c->first);
        return;
    }
    c->second = make_marginal(kind, f, second, across, arena);
    if (along.kind == GAMMA_POWER_U && !first && t->quotient.n > 0) {
        // the fixed exponent along the tangent stands in the quotient
        struct form lobe = {0};
        const struct basis b = basis_make(arena, BASIS_BOX, 1024, SPACING_QUADRATIC);
        const struct form_slot slot = form_add_curve(&lobe, "", GAMMA_POWER_U, FUNCTION_COS_POWER,
                                                     t->quotient.n);
        form_tabulate(&lobe, 0, &b, FILTER_MEAN, arena);
        c->first = make_marginal(kind, &lobe, &slot, along, arena);
    }
    s->count += !is_empty(&c->first) && !is_empty(&c->second);
}

void curve_sampler_init(struct curve_sampler *s, const struct form *f, const struct form_term *t,
                        struct arena *arena) {
    const struct form_slot *a = &t->slots[SLOT_A], *b = &t->slots[SLOT_B];
    const bool has_a = a->gamma.kind != GAMMA_NONE, has_b = b->gamma.kind != GAMMA_NONE;
    const enum curve_strategy_kind ka = kind_of(a->gamma.kind), kb = kind_of(b->gamma.kind);
    *s = (struct curve_sampler){.count = 1, .strategy = {{.kind = STRATEGY_COSINE}}};
    const bool joined = has_a && has_b && ka == kb && is_pair(ka) &&
                        is_second(a->gamma.kind) != is_second(b->gamma.kind);
    if (joined) {
        const bool swap = is_second(a->gamma.kind);
        add_strategy(s, ka, f, t, swap ? b : a, swap ? a : b, arena);
    } else {
        if (has_a)
            add_strategy(s, ka, f, t, is_second(a->gamma.kind) ? NULL : a,
                         is_second(a->gamma.kind) ? a : NULL, arena);
        if (has_b)
            add_strategy(s, kb, f, t, is_second(b->gamma.kind) ? NULL : b,
                         is_second(b->gamma.kind) ? b : NULL, arena);
    }
    for (uint32_t i = 0; i < s->count; i++)
        s->strategy[i].share = 1.0 / s->count;
}

// ---- densities ------------------------------------------------------------------------------

// plane_slope along an axis that has this share of x^2 + y^2 = -2 log(cos_h).
static double plane_slope_at(const struct gamma *g, double share, struct angles *a) {
    const double x2 = 2 * angles_log(a) * share;
    if (g->kind == GAMMA_RATIO)
        return (1 + g->n * x2) / sqrt(g->n);
    return x2 > 1e-16 ? sqrt(expm1(x2) / x2) : 1;
}

// Density of half vectors per solid angle.
static double half_pdf(const struct curve_strategy *s, struct angles *a) {
    const double c = a->cos_h;
    const double p = marginal_pdf(&s->first, a, s->kind) * marginal_pdf(&s->second, a, s->kind);
    if (!(p > 0) || s->kind == STRATEGY_POLAR) // over sin^2 theta_h and a quarter turn
        return p * 0.5 * c;
    if (s->kind == STRATEGY_SLOPE) { // d gamma = cos^2(gamma) d slope, d slopes = dh / cos_h^3
        const double tx = sqr_d(a->h[0] / a->h[2]), ty = sqr_d(a->h[1] / a->h[2]);
        return 0.25 * p / ((1 + tx) * (1 + ty) * c * c * c);
    }
    const double jacobian = plane_slope_at(&s->first.gamma, a->cos2_phi, a) *
                            plane_slope_at(&s->second.gamma, a->sin2_phi, a);
    return 0.25 * p / (jacobian * c); // dh = cos_h of the plane
}

double curve_strategy_pdf_sa(const struct curve_strategy *s, struct direction wo,
                             struct direction wi, struct angles *a) {
    struct half_vector v;
    switch (s->kind) {
    case STRATEGY_COSINE: return wi.z / M_PI;
    case STRATEGY_LIGHT: return marginal_pdf(&s->first, a, s->kind) * wi.z / M_PI;
    case STRATEGY_MIRROR:
    case STRATEGY_DIFFERENCE: return marginal_pdf(&s->first, a, s->kind) / (4 * M_PI);
    default: return half_vector_make(wo, wi, &v) ? half_vector_pdf(&v, half_pdf(s, a)) : 0;
    }
}

double curve_sampler_pdf_sa(const struct curve_sampler *s, struct direction wo,
                            struct direction wi, struct angles *a) {
    double sum = 0;
    for (uint32_t i = 0; i < s->count; i++)
        if (s->strategy[i].share > 0)
            sum += s->strategy[i].share * curve_strategy_pdf_sa(&s->strategy[i], wo, wi, a);
    return sum;
}

// ---- samples --------------------------------------------------------------------------------

// Takes the sign from u and gives u back in [0, 1).
static double take_sign(double *u) {
    const double sign = *u < 0.5 ? -1 : 1;
    *u = *u < 0.5 ? 2 * *u : 2 * *u - 1;
    return sign;
}

// Around n, x = sin^2(theta).
static struct direction around_normal(double x, double phi) {
    const double s = sqrt(x);
    return (struct direction){s * cos(phi), s * sin(phi), sqrt(1 - x)};
}

static struct direction half_sample(const struct curve_strategy *s, double u, double v) {
    if (s->kind == STRATEGY_POLAR) {
        const double su = take_sign(&v), x = marginal_sample(&s->first, u);
        const double sv = take_sign(&v), phi = marginal_sample(&s->second, v);
        const struct direction h = around_normal(x, phi);
        return (struct direction){su * h.x, sv * h.y, h.z};
    }
    const double su = take_sign(&u), sv = take_sign(&v);
    const double a = marginal_sample(&s->first, u), b = marginal_sample(&s->second, v);
    if (s->kind == STRATEGY_SLOPE)
        return direction_of(su * tan(a), sv * tan(b), 1);
    const double x = fmin(plane_coordinate(&s->first.gamma, a), 30);
    const double y = fmin(plane_coordinate(&s->second.gamma, b), 30);
    const double l = 0.5 * (x * x + y * y), r = sqrt(2 * l), sine = sqrt(-expm1(-2 * l));
    const double scale = r > 0 ? sine / r : 1;
    return (struct direction){su * x * scale, sv * y * scale, exp(-l)};
}

// Around an axis, x = sin^2 of half the angle.
static struct direction around(struct direction axis, double x, double phi) {
    return direction_around(axis, 1 - 2 * x, 2 * sqrt(x * (1 - x)), phi);
}

struct direction curve_strategy_sample(const struct curve_strategy *s, struct direction wo,
                                       double left, double u, double v) {
    const double phi = 2 * M_PI * v;
    const struct direction mirror = {-wo.x, -wo.y, wo.z};
    switch (s->kind) {
    case STRATEGY_COSINE: return around_normal(u, phi);
    case STRATEGY_LIGHT: return around_normal(marginal_sample(&s->first, u), phi);
    case STRATEGY_MIRROR: return around(mirror, marginal_sample(&s->first, u), phi);
    case STRATEGY_DIFFERENCE: return around(wo, marginal_sample(&s->first, u), phi);
    default: return half_vector_reflect(wo, half_sample(s, u, v), left);
    }
}

struct direction curve_sampler_sample(const struct curve_sampler *s, struct direction wo,
                                      double u1, double u, double v) {
    uint32_t i = 0;
    while (i + 1 < s->count && u1 >= s->strategy[i].share) {
        u1 -= s->strategy[i].share;
        i++;
    }
    const double left = s->strategy[i].share > 0 ? u1 / s->strategy[i].share : 0;
    return curve_strategy_sample(&s->strategy[i], wo, fmin(left, 1), u, v);
}
