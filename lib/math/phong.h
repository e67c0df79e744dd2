// SPDX-License-Identifier: Apache-2.0
// The modified Phong model (Lafortune and Willems 1994, Using the Modified Phong Reflectance Model
// for Physically Based Rendering): f = (n + 2) / (2 pi) cos^n(theta_r), theta_r between wi and the
// mirror direction. Its directional albedo is at most 1, and 1 at normal incidence.
#pragma once

#include "math/direction.h"

// cos(theta_r); symmetric in wo and wi.
static inline double phong_cos_r(struct direction wo, struct direction wi) {
    return wo.z * wi.z - wo.x * wi.x - wo.y * wi.y;
}

// c^n where c > 0, else 0; also for n = 0.
static inline double cosine_power(double c, double n) {
    return c > 0 ? pow(c, n) : 0;
}

static inline double phong_brdf(struct direction wo, struct direction wi, double n) {
    return (n + 2) / (2 * M_PI) * cosine_power(phong_cos_r(wo, wi), n);
}

// Density of cosine_lobe_sample at an angle of cosine c with the axis.
static inline double cosine_lobe_pdf(double c, double n) {
    return (n + 1) / (2 * M_PI) * cosine_power(c, n);
}

// u, v in [0, 1)
static inline struct direction cosine_lobe_sample(struct direction axis, double n, double u,
                                                  double v) {
    const double l = log1p(-u) / (n + 1); // of the cosine
    return direction_around(axis, exp(l), sqrt(-expm1(2 * l)), 2 * M_PI * v);
}
