// SPDX-License-Identifier: Apache-2.0
// Diffuse-like material in two factors: f_A over theta_i, f_o over theta_o; Lambert where both
// are 1.
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    (void)arena;
    struct form_term *t = form_add_term(f, "even", QUOTIENT_ONE, p->reflectance, 1 / M_PI);
    t->slots[SLOT_O] = form_add_curve(f, "view", GAMMA_THETA_O, FUNCTION_CONSTANT, 1);
    t->slots[SLOT_A] = form_add_curve(f, "light", GAMMA_THETA_I, FUNCTION_CONSTANT, 1);
}

const struct model model_lightview = {"lightview", "factors of theta_i and theta_o; else Lambert",
                                      make};
