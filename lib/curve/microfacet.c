// SPDX-License-Identifier: Apache-2.0
// Microfacets with any distribution of normals p(theta_h) (Ashikhmin, Premoze, Shirley 2000, A
// Microfacet-based BRDF Generator, the uncorrelated form):
//
//     f = p(h) <h.n> F(theta_d) / (4 g(k1) g(k2)),    <h.n> = g(n)
//
// p in f_A (cos^n, or a file), F in f_B. The projected areas g are computed from p and fixed in the
// quotient; f does not depend on the scale of p then, an edit of p alone scales it.
#include <math.h>

#include "curve/model.h"

struct facets {
    const struct curve_function *p;
    double root; // of g(n)
};

static double area(const void *ctx, double theta) {
    const struct facets *s = ctx;
    const struct basis *b = s->p->table ? &s->p->table->basis : NULL;
    return facet_area(function_at, s->p, b ? b->knots : NULL, b ? basis_knots(b) : 0, theta) /
           s->root;
}

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_FACETS, p->reflectance, 0.25);
    t->slots[SLOT_A] = form_add_curve(f, "facets", GAMMA_THETA_H, FUNCTION_COS_POWER,
                                      p->exponent_u);
    model_add_fresnel(f, t, p);
    struct curve_function normals = f->curve[t->slots[SLOT_A].curve].f[0];
    if (p->curve[MODEL_CURVE_A])
        normals = (struct curve_function){.kind = FUNCTION_TABLE, .table = p->curve[MODEL_CURVE_A]};
    struct facets s = {&normals, 1};
    s.root = sqrt(area(&s, 0));
    struct profile *g = arena_alloc(arena, sizeof *g);
    profile_fit(g, area, &s);
    t->quotient.g = g;
}

const struct model model_microfacet = {
    "microfacet", "any distribution of facet normals, curves over theta_h and theta_d", make};
