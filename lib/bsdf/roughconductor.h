// SPDX-License-Identifier: Apache-2.0
// The data of rough metal, shared by its two ways of being shaded.
#pragma once

#include "bsdf/bsdf_wide.h"
#include "bsdf/roughness.h"
#include "bsdf/smooth.h"

struct roughconductor {
    struct conductor_index index;
    struct roughness roughness;
    struct texture_ref reflectance;
    int energy;
    // made by prepare
    bool rough;               // `facets` everywhere
    struct microfacet facets;
    struct facet_loss loss;
    spectrum mean_fresnel;
};

extern const struct wide_bsdf roughconductor_wide[]; // by enum microfacet_type
