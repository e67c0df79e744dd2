// SPDX-License-Identifier: Apache-2.0
// What the rough boundary of a dielectric reflects and transmits of light from a direction, by its
// cosine, single scattering (math/microfacet.h): for coats over other materials.
#pragma once

#include "math/microfacet.h"

enum { BOUNDARY_TABLE = 128 };

struct boundary_table { // entry i is of cosine (i / BOUNDARY_TABLE)^2
    float reflected[BOUNDARY_TABLE + 1], transmitted[BOUNDARY_TABLE + 1];
};

// From the side whose other has `eta` times the index, by quadrature with nodes x nodes points.
void boundary_tabulate(const struct microfacet *facets, float eta, int nodes,
                       struct boundary_table *t);

// One of its two tables at a cosine of 0 to 1.
static inline float boundary_lookup(const float table[BOUNDARY_TABLE + 1], float cosine) {
    const float x = sqrtf(cosine) * BOUNDARY_TABLE;
    const int i = (int)minf(x, BOUNDARY_TABLE - 1);
    return lerpf(x - (float)i, table[i], table[i + 1]);
}
