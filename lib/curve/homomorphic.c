// SPDX-License-Identifier: Apache-2.0
// Homomorphic factorisation (McCool, Ang, Ahmad 2001) of an isotropic material: P(theta_i)
// Q(theta_h) P(theta_o), Q in f_A, the same P in f_B and f_o: one edit of P changes both.
#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_ONE, p->reflectance, 1);
    t->slots[SLOT_A] = form_add_curve(f, "Q", GAMMA_THETA_H, FUNCTION_CONSTANT, 1);
    t->slots[SLOT_B] = form_add_curve(f, "P", GAMMA_THETA_I, FUNCTION_CONSTANT, 1);
    t->slots[SLOT_O] = (struct form_slot){{GAMMA_THETA_O, 0}, t->slots[SLOT_B].curve};
}

const struct model model_homomorphic = {
    "homomorphic", "factors P(theta_i) Q(theta_h) P(theta_o), from files", make};
