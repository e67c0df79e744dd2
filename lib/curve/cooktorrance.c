// SPDX-License-Identifier: Apache-2.0
// Cook-Torrance: f_A = Beckmann's distribution of theta_h, f_B the Fresnel reflectance of a complex
// index, rho_q = G / (cos_i cos_o). f_q = 1 / (4 pi) keeps energy; 1 / pi as printed by Cook and
// Torrance 1982 and Ben-Artzi 2007 reflects up to 4 times what arrives.
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_V_CAVITY, p->reflectance,
                                        p->literal ? 1 / M_PI : 1 / (4 * M_PI));
    t->slots[SLOT_A] = form_add_curve(f, "lobe", GAMMA_THETA_H, FUNCTION_BECKMANN, p->alpha_u);
    model_add_fresnel(f, t, p);
}

const struct model model_cooktorrance = {
    "cooktorrance", "Cook-Torrance, curves over theta_h and theta_d", make};
