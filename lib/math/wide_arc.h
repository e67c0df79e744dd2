// SPDX-License-Identifier: Apache-2.0
// Logarithms and exponentials near 0, and the arc tangent, of a number a lane: to a few
// units in the last place of the result, also where that is small. Coefficients of Cephes.
#pragma once

#include "math/wide_elementary.h"

// log(1 + x), x >= 0, and e^x - 1, by Kahan's corrections: the rounding of 1 + x or e^x is the same
// above and below the fraction.
static inline wide wide_log1p(wide x) {
    const wide u = 1 + x, d = u - 1;
    return wide_select(d > 0, wide_log(u) * (x / wide_select(d > 0, d, wide_of(1))), x);
}

static inline wide wide_expm1(wide x) {
    const wide u = wide_exp(x), d = u - 1, l = wide_log(u);
    const wide_mask small = d == 0;
    return wide_select(small, x, d * (x / wide_select(small, wide_of(1), l)));
}

// Angle of (x, y) from the x axis, in [-pi, pi]; 0 of (0, 0).
static inline wide wide_atan2(wide y, wide x) {
    const wide ax = wide_abs(x), ay = wide_abs(y);
    const wide high = wide_max(ax, ay), low = wide_min(ax, ay);
    const wide t = low / wide_select(high > 0, high, wide_of(1));
    const wide_mask far = t > 0.41421356f; // tan(pi/8)
    const wide r = wide_select(far, (t - 1) / (t + 1), t), z = r * r;
    const wide p = ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z -
                   3.33329491539e-1f;
    wide a = (p * z * r + r) + wide_select(far, wide_of(PI / 4), wide_of(0));
    a = wide_select(ay > ax, PI / 2 - a, a);
    a = wide_select(x < 0, PI - a, a);
    return wide_negate(y < 0, a);
}
