// SPDX-License-Identifier: Apache-2.0
// Ashikhmin-Shirley with an editable Fresnel reflectance at normal incidence: Schlick's form
// R + (1 - R) (1 - cos_d)^5 makes two terms that share both curves, with f_q times R and 1 - R and
// with (1 - cos_d)^5 in the quotient of the second. No third curve is needed.
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    const double norm = sqrt((p->exponent_u + 1) * (p->exponent_v + 1)) / (8 * M_PI);
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_ASHIKHMIN, p->reflectance, norm);
    t->slots[SLOT_A] = form_add_curve(f, "lobe_u", GAMMA_POWER_U, FUNCTION_COS_POWER,
                                      p->exponent_u);
    t->slots[SLOT_B] = form_add_curve(f, "lobe_v", GAMMA_POWER_V, FUNCTION_COS_POWER,
                                      p->exponent_v);
    struct form_term *grazing = form_add_term(f, "grazing", QUOTIENT_ASHIKHMIN, p->reflectance,
                                              norm);
    grazing->slots[SLOT_A] = t->slots[SLOT_A];
    grazing->slots[SLOT_B] = t->slots[SLOT_B];
    grazing->quotient.has_fresnel = true;
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        grazing->quotient.fresnel[k] = (struct curve_function){.kind = FUNCTION_SCHLICK_F};
        t->scale[k] *= p->r0[k];
        grazing->scale[k] *= 1 - p->r0[k];
    }
}

const struct model model_ashikhminfresnel = {
    "ashikhminfresnel", "Ashikhmin-Shirley, two terms with an editable Fresnel reflectance", make};
