// SPDX-License-Identifier: Apache-2.0
// The data of a diffuse base under a rough coat, shared by its two ways of being shaded.
#pragma once

#include "bsdf/boundary_table.h"
#include "bsdf/bsdf_wide.h"
#include "bsdf/roughness.h"
#include "bsdf/smooth.h"

struct roughplastic {
    struct dielectric_index index;
    struct texture_ref diffuse, specular;
    bool nonlinear;
    int distribution;
    float alpha;
    int energy;
    // made by prepare
    struct plastic_coat coat;     // its `leaving` is of the rough coat where there is one
    struct microfacet facets;
    bool smooth;
    float mean_transmitted;       // 2 * integral of T(c) c dc
    struct boundary_table outside;
    struct facet_loss loss; // on the outside
    float regained;         // share of the loss that the coat reflects
};

extern const struct wide_bsdf roughplastic_wide[]; // by enum microfacet_type
