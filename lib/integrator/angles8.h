// SPDX-License-Identifier: Apache-2.0
// Angles of curves (curve/angles.h) for eight pairs of directions at once, lane by lane with the bits
// of those for one.
#pragma once

#include "curve/angles.h"
#include "curve/basis.h"
#include "math/wide_double.h"

struct directions8 {
    wide_double x, y, z;
};

// As struct angles, without what depends on the azimuth of h.
struct angles8 {
    struct directions8 wo, wi;
    wide_double length; // of h = wi + wo
    wide_double cos_d, sin_d, cos_h, sin_h;
    wide_double gamma[GAMMA_COUNT];
    uint32_t known; // gammas that were asked for already, a bit each
};

static inline struct directions8 directions8_of(wide_double x, wide_double y, wide_double z) {
    const wide_double inv = 1 / wide_double_sqrt(x * x + y * y + z * z);
    return (struct directions8){x * inv, y * inv, z * inv};
}

struct angles8 angles8_between(struct directions8 wo, struct directions8 wi);
// Of theta_h, theta_d, theta_i and theta_r.
bool gamma8_fits(enum gamma_kind kind);
wide_double gamma8_at(enum gamma_kind kind, struct angles8 *a);
