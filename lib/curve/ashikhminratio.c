// SPDX-License-Identifier: Apache-2.0
// Ashikhmin-Shirley with one curve: the exponent nu along the tangent is fixed and stands in the
// quotient and in gamma; the curve has the ratio r = nv / nu of the exponents,
//
//     cos(theta_h)^(nv sin^2 phi_h) = g^r = exp(-r tan^2(gamma) / 2),  tan(gamma) = sqrt(-2 log g)
//
// Ben-Artzi 2007 has g in [0, 1] itself for gamma, with the curve g^r: where r is below 1 all that
// is seen then lies in the first bins (with nu = 225, r = 0.1, half the peak at 0.001).
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    const double nu = fmax(p->exponent_u, 1e-3), r = p->exponent_v / nu;
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_ASHIKHMIN, p->reflectance,
                                        sqrt((nu + 1) * (p->exponent_v + 1)) / (8 * M_PI));
    t->quotient.n = nu;
    t->quotient.has_fresnel = true;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        t->quotient.fresnel[k] = (struct curve_function){.kind = FUNCTION_SCHLICK_F,
                                                         .p = {p->r0[k]}};
    t->slots[SLOT_A] = form_add_curve(f, "ratio", GAMMA_RATIO, FUNCTION_GAUSSIAN, sqrt(2 / r));
    t->slots[SLOT_A].gamma.n = nu;
}

const struct model model_ashikhminratio = {
    "ashikhminratio", "Ashikhmin-Shirley, one curve for the ratio of the exponents", make};
