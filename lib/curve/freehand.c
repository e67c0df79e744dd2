// SPDX-License-Identifier: Apache-2.0
// One term of free choice: a quotient, and a gamma for each curve, which start as 1.
#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    static const char *const names[SLOTS] = {"view", "A", "B"};
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", p->quotient, p->reflectance, 1);
    for (int s = 0; s < SLOTS; s++) {
        if (p->gamma[s] == GAMMA_NONE)
            continue;
        t->slots[s] = form_add_curve(f, names[s], p->gamma[s], FUNCTION_CONSTANT, 1);
        t->slots[s].gamma.n = p->exponent_u;
    }
    t->quotient.n = p->gamma[SLOT_A] == GAMMA_RATIO ? p->exponent_u : 0;
    t->quotient.roughness = p->alpha_u * p->alpha_u;
    t->quotient.isotropy = p->isotropy;
}

const struct model model_freehand = {"freehand", "curves and quotient of free choice", make};
