// SPDX-License-Identifier: Apache-2.0
#include "bsdf/boundary_table.h"

void boundary_tabulate(const struct microfacet *facets, float eta, int nodes,
                       struct boundary_table *t) {
    for (int i = 0; i <= BOUNDARY_TABLE; i++) {
        const float s = (float)i / BOUNDARY_TABLE;
        double r, through;
        microfacet_albedo(facets, eta, maxf(s * s, 1e-6f), nodes, &r, &through);
        t->reflected[i] = (float)r;
        t->transmitted[i] = (float)through;
    }
}
