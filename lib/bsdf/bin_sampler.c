// SPDX-License-Identifier: Apache-2.0
#include "bsdf/bin_sampler.h"

static const double COSINE_SHARE = 0.25;

// Whether a marginal stands for a curve of the form (and not for a fixed factor, or for none).
static bool is_curve(const struct curve_marginal *m, const struct form *f) {
    for (uint32_t c = 0; c < f->curves && m->basis; c++)
        if (m->basis->knots == f->curve[c].f[0].table->basis.knots)
            return true;
    return false;
}

static bool same_marginal(const struct curve_marginal *a, const struct curve_marginal *b) {
    if (a->gamma.kind != b->gamma.kind || a->gamma.n != b->gamma.n || !a->basis != !b->basis)
        return false;
    return !a->basis || basis_equal(a->basis, b->basis);
}

static bool is_known(const struct bin_sampler *s, const struct curve_strategy *c) {
    for (uint32_t i = 0; i < s->count; i++)
        if (s->strategy[i].kind == c->kind && same_marginal(&s->strategy[i].first, &c->first) &&
            same_marginal(&s->strategy[i].second, &c->second))
            return true;
    return false;
}

// The form with curves of 1: the strategies of a curve that is 0 now are needed too.
static void make_white(const struct form *f, struct form *white, struct arena *arena) {
    *white = *f;
    for (uint32_t c = 0; c < f->curves; c++) {
        struct curve *table = arena_alloc(arena, sizeof *table);
        *table = curve_make(arena, &f->curve[c].f[0].table->basis, 1);
        for (uint32_t j = 0; j < table->basis.count; j++)
            table->values[j] = 1;
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            white->curve[c].f[k] = (struct curve_function){.kind = FUNCTION_TABLE, .table = table};
    }
}

void bin_sampler_init(struct bin_sampler *s, const struct form *f, struct arena *arena) {
    struct form white;
    make_white(f, &white, arena);
    *s = (struct bin_sampler){.count = 1, .strategy = {{.kind = STRATEGY_COSINE}}};
    for (uint32_t t = 0; t < f->terms; t++) {
        struct curve_sampler term;
        curve_sampler_init(&term, &white, &white.term[t], arena);
        for (uint32_t i = 1; i < term.count; i++) {
            struct curve_strategy *c = &term.strategy[i];
            if (c->kind == STRATEGY_LIGHT) // the cosine does as well
                continue;
            if (is_curve(&c->first, f))
                curve_marginal_level(&c->first, arena);
            if (is_curve(&c->second, f))
                curve_marginal_level(&c->second, arena);
            if (!is_known(s, c))
                s->strategy[s->count++] = *c;
        }
    }
    for (uint32_t i = 0; i < s->count; i++)
        s->strategy[i].share = i == 0 && s->count > 1 ? COSINE_SHARE
                               : i == 0               ? 1
                                        : (1 - COSINE_SHARE) / (s->count - 1);
}

// The part of a strategy's first variable that wo can reach: theta_h is at most half way between wo
// and the horizon, and sin^2 of that is (1 + sin theta_o) / 2.
static double reach(const struct curve_strategy *s, double sine) {
    if (s->kind != STRATEGY_POLAR || s->first.gamma.kind != GAMMA_THETA_H)
        return 1;
    return curve_marginal_cdf(&s->first, 0.5 + 0.5 * sine);
}

struct bin_view bin_sampler_view(const struct bin_sampler *s, struct direction wo) {
    struct bin_view v = {.wo = wo};
    const double sine = fmin(sqrt(wo.x * wo.x + wo.y * wo.y), 1);
    for (uint32_t i = 0; i < s->count; i++)
        v.reach[i] = reach(&s->strategy[i], sine);
    return v;
}

double bin_sampler_pdf_sa(const struct bin_sampler *s, const struct bin_view *v,
                          struct direction wi, struct angles *a) {
    double sum = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const struct curve_strategy *c = &s->strategy[i];
        sum += c->share * curve_strategy_pdf_sa(c, v->wo, wi, a) / v->reach[i];
    }
    return sum;
}

struct direction bin_sampler_sample(const struct bin_sampler *s, const struct bin_view *v,
                                    double left, double u1, double u2) {
    uint32_t i = 0;
    while (i + 1 < s->count && u1 >= s->strategy[i].share)
        u1 -= s->strategy[i++].share;
    const struct curve_strategy *c = &s->strategy[i];
    u1 = fmin(u1 / c->share, 1 - 0x1p-53) * v->reach[i];
    return curve_strategy_sample(c, v->wo, left, u1, u2);
}
