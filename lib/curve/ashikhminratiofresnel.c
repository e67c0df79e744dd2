// SPDX-License-Identifier: Apache-2.0
// Ashikhmin-Shirley with one curve for the ratio of the exponents and an editable Fresnel reflectance
// at normal incidence: the two terms of ashikhminfresnel, each with the curve of ashikhminratio.
#include <math.h>

#include "curve/model.h"

static void make(const struct model_parameters *p, struct arena *arena, struct form *f) {
    const double nu = fmax(p->exponent_u, 1e-3), r = p->exponent_v / nu;
    const double norm = sqrt((nu + 1) * (p->exponent_v + 1)) / (8 * M_PI);
    (void)arena;
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_ASHIKHMIN, p->reflectance, norm);
    t->quotient.n = nu;
    t->slots[SLOT_A] = form_add_curve(f, "ratio", GAMMA_RATIO, FUNCTION_GAUSSIAN, sqrt(2 / r));
    t->slots[SLOT_A].gamma.n = nu;
    struct form_term *grazing = form_add_term(f, "grazing", QUOTIENT_ASHIKHMIN, p->reflectance,
                                              norm);
    grazing->quotient.n = nu;
    grazing->quotient.has_fresnel = true;
    grazing->slots[SLOT_A] = t->slots[SLOT_A];
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        grazing->quotient.fresnel[k] = (struct curve_function){.kind = FUNCTION_SCHLICK_F};
        t->scale[k] *= p->r0[k];
        grazing->scale[k] *= 1 - p->r0[k];
    }
}

const struct model model_ashikhminratiofresnel = {
    "ashikhminratiofresnel", "the same in two terms with an editable Fresnel reflectance", make};
