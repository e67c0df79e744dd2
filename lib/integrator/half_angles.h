// SPDX-License-Identifier: Apache-2.0
// Angles of curves (curve/angles.h) for a pair of directions in each of half the lanes, with the bits of
// those for one.
#pragma once

#include "curve/angles.h"
#include "curve/basis.h"
#include "math/wide_double.h"

struct half_directions {
    wide_double x, y, z;
};

// As struct angles, without what depends on the azimuth of h.
struct half_angles {
    struct half_directions wo, wi;
    wide_double length; // of h = wi + wo
    wide_double cos_d, sin_d, cos_h, sin_h;
    wide_double gamma[GAMMA_COUNT];
    uint32_t known; // gammas that were asked for already, a bit each
};

static inline struct half_directions half_directions_of(wide_double x, wide_double y, wide_double z) {
    const wide_double inv = 1 / wide_double_sqrt(x * x + y * y + z * z);
    return (struct half_directions){x * inv, y * inv, z * inv};
}

struct half_angles half_angles_between(struct half_directions wo, struct half_directions wi);
// Of theta_h, theta_d, theta_i and theta_r.
bool half_gamma_fits(enum gamma_kind kind);
wide_double half_gamma_at(enum gamma_kind kind, struct half_angles *a);
