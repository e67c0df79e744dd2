// SPDX-License-Identifier: Apache-2.0
// A box around facets that follow one another: rays that all pass it need not look at them.
#pragma once

#include "accel/accel.h"

struct few_box {
    uint32_t first, count; // facets
    float lo[3], hi[3];
    float extent; // largest coordinate
};

// What the test needs of rays, for all boxes.
struct few_slabs {
    struct wide3 inverse; // of d
    wide slack;           // for the origin's share of rounding
};

// What is forgiven, of the largest coordinate: far above what rounding does to the test of a facet.
static const float FEW_BOX_SLACK = 1e-5f;

static inline wide few_inverse(wide d) {
    const wide tiny = wide_of(1e-37f); // no infinity, which times zero would be NaN
    return 1 / wide_select(wide_abs(d) < tiny, tiny, d);
}

static inline struct few_slabs few_slabs_of(const struct accel_rays *r) {
    const struct wide3 o = wide3_abs(r->o);
    return (struct few_slabs){{few_inverse(r->d.x), few_inverse(r->d.y), few_inverse(r->d.z)},
                              FEW_BOX_SLACK * wide_max(o.x, wide_max(o.y, o.z))};
}

// Narrows [near, far] to where the rays are between two planes.
static inline void few_slab(wide o, wide inverse, float lo, float hi, wide slack, wide *near,
                            wide *far) {
    const wide a = (lo - slack - o) * inverse, b = (hi + slack - o) * inverse;
    *near = wide_max(wide_min(a, b), *near);
    *far = wide_min(wide_max(a, b), *far);
}

// Whether any ray may meet the box before tmax.
static inline bool few_box_is_met(const struct few_box *box, const struct accel_rays *r,
                                  const struct few_slabs *s, wide tmax) {
    const wide slack = s->slack + FEW_BOX_SLACK * box->extent;
    wide near = r->tmin, far = tmax;
    few_slab(r->o.x, s->inverse.x, box->lo[0], box->hi[0], slack, &near, &far);
    few_slab(r->o.y, s->inverse.y, box->lo[1], box->hi[1], slack, &near, &far);
    few_slab(r->o.z, s->inverse.z, box->lo[2], box->hi[2], slack, &near, &far);
    return wide_any(near * (1 - FEW_BOX_SLACK) <= far * (1 + FEW_BOX_SLACK));
}
