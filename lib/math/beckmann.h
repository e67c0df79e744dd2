// SPDX-License-Identifier: Apache-2.0
// The anisotropic Beckmann distribution in double precision (Beckmann and Spizzichino 1963; Ward
// 1992 for the anisotropic form), without a limit of roughness; math/microfacet.h is the fast one.
//
//     D(h) = exp(-e) / (pi mx my cos_h^4)
//     e = tan^2(theta_h) (cos^2 phi_h / mx^2 + sin^2 phi_h / my^2)
//
// The integral of D cos_h over the hemisphere is 1.
#pragma once

#include "math/direction.h"

struct beckmann {
    double mx, my; // > 0: root mean square slope along x and y, times sqrt 2
};

// e; infinite on the horizon
static inline double beckmann_exponent(const struct beckmann *b, struct direction h) {
    const double x = h.x / (b->mx * h.z), y = h.y / (b->my * h.z);
    return x * x + y * y;
}

static inline double beckmann_D(const struct beckmann *b, struct direction h) {
    if (!(h.z > 0))
        return 0;
    const double e = beckmann_exponent(b, h), z2 = h.z * h.z;
    return e < 700 ? exp(-e) / (M_PI * b->mx * b->my * z2 * z2) : 0;
}

// A half vector with density D cos_h; u, v in [0, 1).
static inline struct direction beckmann_sample(const struct beckmann *b, double u, double v) {
    const double slope = sqrt(-log1p(-u)), phi = 2 * M_PI * v;
    return direction_of(b->mx * slope * cos(phi), b->my * slope * sin(phi), 1);
}
