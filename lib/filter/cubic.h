// SPDX-License-Identifier: Apache-2.0
// The cubic splines of Mitchell and Netravali 1988, Reconstruction Filters in Computer Graphics,
// equation 8.
#pragma once

#include <math.h>

static inline float cubic_spline(float x, float b, float c) {
    x = fabsf(x);
    if (x >= 2)
        return 0;
    if (x < 1)
        return (((12 - 9 * b - 6 * c) * x + (-18 + 12 * b + 6 * c)) * x * x + (6 - 2 * b)) / 6;
    return ((((-b - 6 * c) * x + (6 * b + 30 * c)) * x + (-12 * b - 48 * c)) * x +
            (8 * b + 24 * c)) / 6;
}
