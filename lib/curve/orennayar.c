// SPDX-License-Identifier: Apache-2.0
// Oren and Nayar 1994, the qualitative model (sigma = alpha / sqrt 2): the roughness only scales
// two fixed terms. Curves of 1 over theta_i and theta_o, which both share, are there to be bent.
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    const double s2 = 0.5 * p->alpha_u * p->alpha_u;
    const double a = 1 - 0.5 * s2 / (s2 + 0.33), b = 0.45 * s2 / (s2 + 0.09);
    (void)arena;
    struct form_term *t = form_add_term(f, "even", QUOTIENT_ONE, p->reflectance, a / M_PI);
    t->slots[SLOT_O] = form_add_curve(f, "view", GAMMA_THETA_O, FUNCTION_CONSTANT, 1);
    t->slots[SLOT_A] = form_add_curve(f, "light", GAMMA_THETA_I, FUNCTION_CONSTANT, 1);
    struct form_term *rough = form_add_term(f, "rough", QUOTIENT_OREN_NAYAR, p->reflectance,
                                            b / M_PI);
    rough->slots[SLOT_O] = t->slots[SLOT_O];
    rough->slots[SLOT_A] = t->slots[SLOT_A];
}

const struct model model_orennayar = {"orennayar", "Oren-Nayar, two terms, curves of 1", make};
