// SPDX-License-Identifier: Apache-2.0
// Shares of triangles in the functions of curves (curve/overlap.h): WIDE_LANES triangles are looked at
// together (wide_fit.h), then dealt to as many functions at a time (wide_part.h). The few over which an
// angle bends too much, near its pole, are split (wide_split.h).
#pragma once

#include "integrator/wide_fit.h"

struct wide_overlap {
    struct overlap scalar;
    struct wide_axis axis[OVERLAP_AXES];
};

// Numbers past the end of sums that get zeros.
enum { WIDE_OVERLAP_SPARE = OVERLAP_CHANNELS * WIDE_LANES };

void wide_overlap_init(struct wide_overlap *o, const struct gamma *const gamma[OVERLAP_AXES],
                       const struct basis *const basis[OVERLAP_AXES], uint32_t axes, struct arena *arena);

void wide_overlap_fit(const struct wide_overlap *o, const struct wide_nodes *n,
                      wide gamma[OVERLAP_AXES][OVERLAP_NODES], struct wide_fit fit[OVERLAP_AXES]);

// Adds light times the shares of one of them, which is t, to o->scalar.sums.
void wide_overlap_add(struct wide_overlap *o, const struct wide_fit fit[OVERLAP_AXES],
                      const struct wide_nodes *n, uint32_t lane, const struct overlap_triangle *t,
                      const double light[OVERLAP_CHANNELS]);
