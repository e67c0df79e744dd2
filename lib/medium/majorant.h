// SPDX-License-Identifier: Apache-2.0
// The majorants along a ray: a walk over the cells of a volume's bounds (Amanatides and Woo 1987).
#pragma once

#include "medium/medium.h"

struct majorant_walk {
    const struct medium *m;
    vec3 o, d;       // in cells
    int cell[3];
    float t, end;    // where the next piece begins; where all ends
    bool done;
};

struct majorant_piece {
    float a, b;     // in t of the ray; b may be INFINITY
    spectrum most;  // no sigma_t within is larger
};

// Pieces outside the bounds, where nothing is, are left out.
void majorant_begin(struct majorant_walk *w, const struct medium *m, vec3 o, vec3 d, float end);
bool majorant_next(struct majorant_walk *w, struct majorant_piece *piece);
