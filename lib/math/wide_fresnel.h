// SPDX-License-Identifier: Apache-2.0
// fresnel.h for all lanes, operation by operation.
#pragma once

#include "math/wide.h"

// fresnel_dielectric without the cosine of the refracted direction.
static inline wide wide_fresnel_dielectric(wide cos_i, wide eta) {
    const wide d = (eta - 1) * (eta + 1), c2 = cos_i * cos_i, q2 = c2 + d;
    const wide q = wide_sqrt(q2), e2 = eta * eta;
    const wide s = 1 / (cos_i + q), p = 1 / (q + e2 * cos_i);
    const wide r_s = d * s * s;
    const wide r_p = d * (1 - c2 * (1 + e2)) * p * p;
    const wide one = wide_of(1), none = {0};
    const wide F = wide_min(0.5f * (r_s * r_s + r_p * r_p), one);
    return wide_select(d == 0, none, wide_select(q2 <= 0, one, F));
}

// One channel of fresnel_conductor.
static inline wide wide_fresnel_conductor_channel(wide c, wide eta, wide k) {
    const wide c2 = c * c, s2 = wide_max(1 - c2, wide_of(0));
    const wide m = (eta - 1) * (eta + 1) - k * k + c2;
    const wide ek = eta * k, ek2 = ek * ek, tiny = wide_of(1e-30f);
    const wide norm = wide_sqrt(m * m + 4 * ek2);
    const wide big = 0.5f * (norm + wide_abs(m));
    const wide small = ek2 / wide_max(big, tiny);
    const wide a2 = wide_select(m >= 0, big, small), b2 = wide_select(m >= 0, small, big);
    const wide a = wide_sqrt(a2);
    const wide am = a - c, ap = a + c, pm = c * a - s2, pp = c * a + s2;
    const wide r_s = (am * am + b2) / wide_max(ap * ap + b2, tiny);
    const wide r_p = (pm * pm + c2 * b2) / wide_max(pp * pp + c2 * b2, tiny);
    return wide_min(0.5f * r_s * (1 + r_p), wide_of(1));
}

static inline struct wide3 wide_fresnel_conductor(wide c, struct wide3 eta, struct wide3 k) {
    return (struct wide3){wide_fresnel_conductor_channel(c, eta.x, k.x),
                          wide_fresnel_conductor_channel(c, eta.y, k.y),
                          wide_fresnel_conductor_channel(c, eta.z, k.z)};
}
