// SPDX-License-Identifier: Apache-2.0
// Blinn's form of the Phong highlight (Blinn 1977, Models of Light Reflection for Computer
// Synthesized Pictures) as a distribution of microfacets, D = (n + 2) / (2 pi) cos^n(theta_h),
// which is normalised: the integral of D cos_h is 1. With the grooves of Torrance and Sparrow
//
//     f = D G / (4 cos_o cos_i)     (times the Fresnel reflectance)
#pragma once

#include "math/half_vector.h"

static inline double blinn_phong_D(double cos_h, double n) {
    return cos_h > 0 ? (n + 2) / (2 * M_PI) * pow(cos_h, n) : 0;
}

static inline double blinn_phong_brdf(const struct half_vector *v, double n) {
    return blinn_phong_D(v->cos_h, n) * v_cavity(v) / (4 * v->cos_o * v->cos_i);
}

// A half vector with density D cos_h; u, v in [0, 1).
static inline struct direction blinn_phong_sample(double n, double u, double v) {
    const double l = log1p(-u) / (n + 2), s = sqrt(-expm1(2 * l)), phi = 2 * M_PI * v; // l: log cos
    return (struct direction){s * cos(phi), s * sin(phi), exp(l)};
}
