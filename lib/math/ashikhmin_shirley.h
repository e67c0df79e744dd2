// SPDX-License-Identifier: Apache-2.0
// Ashikhmin and Shirley 2000, An Anisotropic Phong BRDF Model:
//
//     f = sqrt((nu + 1) (nv + 1)) / (8 pi) cos_h^(nu cos^2 phi_h + nv sin^2 phi_h)
//         F / (cos_d max(cos_o, cos_i))
//
// over a diffuse base whose share falls off towards grazing angles,
//
//     f_d = 28 Rd / (23 pi) (1 - Rs) (1 - (1 - cos_o / 2)^5) (1 - (1 - cos_i / 2)^5)
#pragma once

#include "math/half_vector.h"

// Density of half vectors; its integral over the hemisphere is 1.
static inline double ashikhmin_shirley_D(struct direction h, double nu, double nv) {
    const double xx = h.x * h.x, yy = h.y * h.y, s2 = xx + yy;
    const double e = s2 > 0 ? (nu * xx + nv * yy) / s2 : 0;
    return h.z > 0 ? sqrt((nu + 1) * (nv + 1)) / (2 * M_PI) * pow(h.z, e) : 0;
}

// Without F.
static inline double ashikhmin_shirley_brdf(const struct half_vector *v, double nu, double nv) {
    return ashikhmin_shirley_D(v->h, nu, nv) / (4 * v->cos_d * fmax(v->cos_o, v->cos_i));
}

// The base with Rd (1 - Rs) = 1.
static inline double ashikhmin_shirley_base(double cos_o, double cos_i) {
    return 28 / (23 * M_PI) * (1 - schlick_weight(0.5 * cos_o)) * (1 - schlick_weight(0.5 * cos_i));
}

// A half vector with density D; u, v in [0, 1). The paper's azimuth, tan(phi) = sqrt((nu + 1) /
// (nv + 1)) tan(2 pi v), without its four quadrants.
static inline struct direction ashikhmin_shirley_sample(double nu, double nv, double u, double v) {
    const double x = cos(2 * M_PI * v) / sqrt(nu + 1), y = sin(2 * M_PI * v) / sqrt(nv + 1);
    const double r2 = x * x + y * y, e = (nu * x * x + nv * y * y) / r2;
    const double l = log1p(-u) / (e + 1), s = sqrt(-expm1(2 * l) / r2); // l: log cos
    return (struct direction){s * x, s * y, exp(l)};
}
