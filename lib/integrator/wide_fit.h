// SPDX-License-Identifier: Apache-2.0
// How gamma runs over WIDE_LANES triangles: each as four parts over which it is linear, as sixteen over
// which a quadratic through the nodes is, or too curved for either. Where gamma is
// taken to be linear the corners are moved together, so that its mean over the part stays what it is.
#pragma once

#include "integrator/wide_part.h"

enum { FIT_COARSE = 4, FIT_FINE = 16 };

// Nodes in the frame of the closure, and what of the triangles lies in each part.
struct wide_nodes {
    struct wide3 node[OVERLAP_NODES];
    wide part[FIT_COARSE];
    wide tolerance; // of shares of them
};

// A bit for each triangle: most of gamma is negative; it has both signs; it needs sixteen parts; more
// than these; much more.
struct wide_fit {
    wide gamma[OVERLAP_NODES];
    uint32_t first[WIDE_LANES], count[WIDE_LANES]; // functions it touches
    uint32_t turned, straddles, finer, splits, far;
    struct part part[WIDE_LANES][FIT_COARSE];
};

// part: shares of the triangle.
void wide_fit_make(struct wide_fit *f, const struct wide_axis *a, const wide gamma[OVERLAP_NODES],
                   const wide part[FIT_COARSE], wide tolerance);

// One triangle as sixteen parts; straight: as they lie inside the four.
void wide_fit_fine(const struct wide_fit *f, const struct wide_axis *a, uint32_t lane,
                   const float weight[FIT_FINE], bool straight, struct part out[FIT_FINE]);
