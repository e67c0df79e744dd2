// SPDX-License-Identifier: Apache-2.0
// Phong: f_A = cos^n(theta_r). f_q = (n + 2) / (2 pi) (Lafortune and Willems 1994), or sqrt(n) as
// printed by Ben-Artzi 2007, who meant it to keep the brightness while n is dragged.
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    const double n = p->exponent_u;
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_ONE, p->reflectance,
                                        p->literal ? sqrt(n) : (n + 2) / (2 * M_PI));
    t->slots[SLOT_A] = form_add_curve(f, "lobe", GAMMA_THETA_R, FUNCTION_COS_POWER, n);
}

const struct model model_phong = {"phong", "Phong, curve over theta_r", make};
