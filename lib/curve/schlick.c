// SPDX-License-Identifier: Apache-2.0
// Schlick 1994, An Inexpensive BRDF Model: f_A = pi Z(theta_h) of roughness r = alpha_u^2, f_B the
// Fresnel reflectance R + (1 - R) (1 - cos_d)^5. The masking G contains r too; it is fixed in the
// quotient at the value the form is generated with. What facets send back and forth is a second
// term, F (1 - G G) / pi, that shares f_B.
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    const double r = p->alpha_u * p->alpha_u;
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_SCHLICK, p->reflectance,
                                        1 / (4 * M_PI));
    t->slots[SLOT_A] = form_add_curve(f, "lobe", GAMMA_THETA_H, FUNCTION_SCHLICK_Z, r);
    t->slots[SLOT_B] = form_add_curve_rgb(f, "fresnel", GAMMA_THETA_D, FUNCTION_SCHLICK_F, p->r0,
                                          NULL);
    struct form_term *rest = form_add_term(f, "rest", QUOTIENT_SCHLICK_REST, p->reflectance,
                                           1 / M_PI);
    rest->slots[SLOT_A] = t->slots[SLOT_B];
    t->quotient.roughness = rest->quotient.roughness = r;
    t->quotient.isotropy = rest->quotient.isotropy = p->isotropy;
}

const struct model model_schlick = {"schlick", "Schlick, curves over theta_h and theta_d", make};
