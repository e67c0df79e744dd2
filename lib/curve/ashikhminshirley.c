// SPDX-License-Identifier: Apache-2.0
// Ashikhmin and Shirley 2000: cos(theta_h)^(nu cos^2 phi_h + nv sin^2 phi_h) as the product of
// cos^nu(gamma_u) and cos^nv(gamma_v). The Fresnel factor (Schlick's) stays in the quotient.
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    (void)arena;
    struct form_term *t =
        form_add_term(f, "specular", QUOTIENT_ASHIKHMIN, p->reflectance,
                      sqrt((p->exponent_u + 1) * (p->exponent_v + 1)) / (8 * M_PI));
    t->quotient.has_fresnel = true;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        t->quotient.fresnel[k] = (struct curve_function){.kind = FUNCTION_SCHLICK_F,
                                                         .p = {p->r0[k]}};
    t->slots[SLOT_A] = form_add_curve(f, "lobe_u", GAMMA_POWER_U, FUNCTION_COS_POWER,
                                      p->exponent_u);
    t->slots[SLOT_B] = form_add_curve(f, "lobe_v", GAMMA_POWER_V, FUNCTION_COS_POWER,
                                      p->exponent_v);
}

const struct model model_ashikhminshirley = {
    "ashikhminshirley", "Ashikhmin-Shirley, a curve for either exponent", make};
