// SPDX-License-Identifier: Apache-2.0
// Parts of a triangle over which gamma is linear (curve/overlap.h), and what of them the functions of
// a basis have. A function's share is the difference of what lies up to its upper end and up to that
// of the one before: of F itself for boxes, of F's mean over the interval above its node for hats.
// WIDE_LANES functions are asked for at once: few parts then cost little, however many functions they touch.
#pragma once

#include "curve/overlap.h"
#include "math/wide.h"

struct wide_axis {
    const struct overlap_axis *axis;
    bool hat;
    float per_step, step; // of evenly spaced knots; 0: others
    float end;            // what lies beyond belongs to no function; infinite: to the last
    float *edges;         // knots, then the last one again
    float *inverse;       // 1 / width of the intervals, then 0
};

// Gammas at the corners, in order; 1 / ((g1 - g0)(g2 - g0)), 1 / ((g2 - g1)(g2 - g0)); the share
// above g1; what of the triangle the part is, and that up to the axis' end.
struct part {
    float g0, g1, g2, rise, fall, top, weight, inside;
};

// Functions [first, first + count) that some parts touch; straddles: gamma is negative in some.
struct part_run {
    const struct part *part;
    uint32_t parts, first, count;
    bool straddles;
};

void wide_axis_init(struct wide_axis *a, const struct overlap_axis *of, struct arena *arena);

// Parts with these gammas at their corners.
void parts_store(const struct wide_axis *a, wide g0, wide g1, wide g2, wide weight,
                 struct part *const to[WIDE_LANES]);

// Shares of functions from first + at on, part_step of them; those that are not touched have none.
// *done: what lies below them, 0 at first; then below the next.
wide part_shares(const struct wide_axis *a, const struct part_run *r, uint32_t at, float *done);

static inline uint32_t part_step(const struct wide_axis *a) {
    return a->hat ? WIDE_LANES - 1 : WIDE_LANES;
}
