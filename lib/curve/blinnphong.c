// SPDX-License-Identifier: Apache-2.0
// Blinn-Phong facets in V-cavities, normalised: f_A = cos^n(theta_h), f_B the Fresnel reflectance,
// f_q = (n + 2) / (8 pi), rho_q = G / (cos_i cos_o).
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    const double n = p->exponent_u;
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_V_CAVITY, p->reflectance,
                                        (n + 2) / (8 * M_PI));
    t->slots[SLOT_A] = form_add_curve(f, "lobe", GAMMA_THETA_H, FUNCTION_COS_POWER, n);
    model_add_fresnel(f, t, p);
}

const struct model model_blinnphong = {"blinnphong", "Blinn-Phong, curves over theta_h and theta_d",
                                       make};
