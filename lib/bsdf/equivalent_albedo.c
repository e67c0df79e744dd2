// SPDX-License-Identifier: Apache-2.0
#include "bsdf/equivalent_albedo.h"

#include <string.h>

#include "bsdf/bin_sampler.h"
#include "math/hash.h"
#include "math/quadrature.h"

enum { NODES = 8, SAMPLES = 1 << 16, GRID = 64, VISITS = 128, DIMENSIONS = 5 };

static const struct basis *basis_of(const struct form *f, uint32_t term, enum form_slot_name slot) {
    const struct form_slot *s = &f->term[term].slots[slot];
    return s->gamma.kind == GAMMA_NONE ? NULL : &f->curve[s->curve].f[0].table->basis;
}

static uint32_t count_of(const struct basis *b) {
    return b ? b->count : 1;
}

static uint32_t functions_at(const struct basis *b, const struct gamma *g, struct angles *a,
                             uint32_t index[2], double value[2]) {
    if (b)
        return basis_at(b, gamma_at(g, a), index, value);
    index[0] = 0;
    value[0] = 1;
    return 1;
}

// ---- of theta_i alone -----------------------------------------------------------------------

static bool knows_light_alone(const struct form_term *t) {
    const enum gamma_kind a = t->slots[SLOT_A].gamma.kind, b = t->slots[SLOT_B].gamma.kind;
    return t->quotient.kind == QUOTIENT_ONE && !t->quotient.has_fresnel &&
           (a == GAMMA_NONE || a == GAMMA_THETA_I) && b == GAMMA_NONE;
}

// Each integral over wo gives pi; over wi, 2 pi sin cos.
static void integrate(const struct basis *b, double *e) {
    double at[NODES], share[NODES];
    gauss_legendre(NODES, at, share);
    for (uint32_t i = 0; b && i < basis_intervals(b); i++)
        for (int k = 0; k < NODES; k++) {
            const double width = b->knots[i + 1] - b->knots[i], x = b->knots[i] + at[k] * width;
            uint32_t index[2];
            double value[2];
            const uint32_t n = basis_at(b, x, index, value);
            for (uint32_t m = 0; m < n; m++)
                for (int c = 0; c < CURVE_CHANNELS; c++)
                    e[index[m] * CURVE_CHANNELS + (uint32_t)c] +=
                        share[k] * width * M_PI * sin(2 * x) * value[m];
        }
    for (int c = 0; !b && c < CURVE_CHANNELS; c++)
        e[c] = M_PI;
}

// ---- of anything ----------------------------------------------------------------------------

// The form of one term, for its own sampler.
static struct form alone(const struct form *f, uint32_t term) {
    struct form one = *f;
    one.terms = 1;
    one.term[0] = f->term[term];
    return one;
}

// Point i of the sequence of the generalised golden ratio (Roberts 2018).
static void point(uint32_t i, double u[DIMENSIONS]) {
    static const double root = 1.1347241384015194; // x^6 = x + 1
    double step = 1;
    for (int d = 0; d < DIMENSIONS; d++) {
        step /= root;
        const double x = 0.5 + step * (i + 1.0);
        u[d] = x - floor(x);
    }
}

// The same for two curves: a grid over what chooses their bins, all cells of which are visited equally
// often, each by a sequence of its own. (One sequence leaves so few points for a bin that lobes of
// exponents 100 and 200 come out 1 % off.)
static void point_of_two(uint32_t i, double u[DIMENSIONS]) {
    const uint32_t cell = i % (GRID * GRID);
    point(i / (GRID * GRID), u);
    for (uint32_t d = 0; d < DIMENSIONS; d++) {
        const double x = u[d] + hash_u32(cell * DIMENSIONS + d) * 0x1p-32;
        u[d] = x - floor(x);
    }
    u[2] = (cell % GRID + u[2]) / GRID;
    u[3] = (cell / GRID + u[3]) / GRID;
}

static void add_sample(const struct form *f, const struct bin_sampler *s, const double *u,
                       double share, double *e) {
    const struct form_term *t = &f->term[0];
    const struct basis *a = basis_of(f, 0, SLOT_A), *b = basis_of(f, 0, SLOT_B);
    const double sine = sqrt(u[0]), phi = 2 * M_PI * u[1];
    const struct direction wo = {sine * cos(phi), sine * sin(phi), sqrt(1 - u[0])};
    const struct bin_view v = bin_sampler_view(s, wo);
    const struct direction wi = bin_sampler_sample(s, &v, u[4], u[2], u[3]);
    if (!(wi.z > 0 && wo.z > 0))
        return;
    struct angles at = angles_between(wo, wi);
    uint32_t j[2], k[2];
    double x[2], y[2], q[CURVE_CHANNELS];
    const uint32_t m = functions_at(a, &t->slots[SLOT_A].gamma, &at, j, x);
    const uint32_t n = functions_at(b, &t->slots[SLOT_B].gamma, &at, k, y);
    const double pdf = bin_sampler_pdf_sa(s, &v, wi, &at);
    quotient_cos(&t->quotient, &at, q);
    for (uint32_t r = 0; r < m && pdf > 0; r++)
        for (uint32_t l = 0; l < n; l++)
            for (uint32_t c = 0; c < CURVE_CHANNELS; c++)
                e[(j[r] * count_of(b) + k[l]) * CURVE_CHANNELS + c] +=
                    q[c] * x[r] * y[l] / pdf * share;
}

void equivalent_albedo(const struct form *f, uint32_t term, double *e) {
    const struct basis *a = basis_of(f, term, SLOT_A), *b = basis_of(f, term, SLOT_B);
    memset(e, 0, sizeof *e * CURVE_CHANNELS * count_of(a) * count_of(b));
    if (knows_light_alone(&f->term[term])) {
        integrate(a, e);
        return;
    }
    struct arena arena = {0};
    struct bin_sampler s;
    const struct form one = alone(f, term);
    bin_sampler_init(&s, &one, &arena);
    const bool two = a && b;
    const uint32_t samples = two ? GRID * GRID * VISITS : SAMPLES;
    for (uint32_t i = 0; i < samples; i++) {
        double u[DIMENSIONS];
        if (two)
            point_of_two(i, u);
        else
            point(i, u);
        add_sample(&one, &s, u, 1.0 / samples, e);
    }
    arena_finish(&arena);
}
