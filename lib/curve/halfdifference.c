// SPDX-License-Identifier: Apache-2.0
// Measured material in non-negative factors (Lawrence et al. 2006; Ben-Artzi 2007, eq. 3.17):
// H(theta_h) G(theta_d), and a diffuse term with curves over theta_i and theta_o.
#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_ONE, p->reflectance, 1);
    t->slots[SLOT_A] = form_add_curve(f, "half", GAMMA_THETA_H, FUNCTION_CONSTANT, 1);
    t->slots[SLOT_B] = form_add_curve(f, "difference", GAMMA_THETA_D, FUNCTION_CONSTANT, 1);
}

const struct model model_halfdifference = {
    "halfdifference", "factors of theta_h and theta_d, from files", make};
