// SPDX-License-Identifier: Apache-2.0
// Data of an editable material: what its parameters fill, and what prepare makes of them.
#pragma once

#include "bsdf/curve_sampler.h"
#include "bsdf/smooth.h"
#include "curve/model.h"

enum { EDITABLE_CHILDREN = 3, EDITABLE_ANGLES = 16 };

struct editable {
    int model;
    struct texture_ref specular, diffuse;
    float exponent, exponent_u, exponent_v;
    float alpha, alpha_u, alpha_v;
    struct conductor_index index;
    spectrum r0;
    float isotropy;
    int variant, gamma[SLOTS], quotient;
    bool literal, fixed_fresnel;
    const char *curve[MODEL_CURVES]; // files
    const char *edit[SLOTS];         // operators on the first term's curves
    const char *edited;              // file with a form
    int bins, bins_b, bins_constant, basis, spacing, weighting;
    const struct object *child[EDITABLE_CHILDREN]; // more terms

    // made by prepare
    struct form form; // all curves are tables
    const struct texture_ref *texture[FORM_TERMS];
    const spectrum *values[FORM_CURVES]; // per coefficient
    struct curve_sampler sampler[FORM_TERMS];
    // What a term reflects towards wo per unit of factor, at even steps of cos theta_o.
    spectrum albedo[FORM_TERMS][EDITABLE_ANGLES];
    uint32_t lobe[FORM_TERMS]; // of either term
    uint32_t lobes;
};

extern const struct param editable_params[];
bool editable_prepare(struct object *self, struct arena *arena);
