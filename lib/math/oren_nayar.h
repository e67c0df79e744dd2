// SPDX-License-Identifier: Apache-2.0
// Oren and Nayar 1994, Generalization of Lambert's Reflectance Model: V-shaped grooves of
// Lambertian facets, sigma the standard deviation of their slope angle in radians. Functions
// return f times pi without one factor of the reflectance rho.
#pragma once

#include "math/direction.h"

struct oren_nayar_angles {
    double cos_phi;     // of the difference of azimuths
    double alpha, beta; // the greater and the smaller of theta_o and theta_i
    double tan_beta, sin_alpha;
};

static inline struct oren_nayar_angles oren_nayar_angles(struct direction wo, struct direction wi) {
    const double so = sqrt(wo.x * wo.x + wo.y * wo.y), si = sqrt(wi.x * wi.x + wi.y * wi.y);
    const double to = atan2(so, wo.z), ti = atan2(si, wi.z);
    struct oren_nayar_angles a;
    a.cos_phi = so * si > 0 ? fmin(fmax((wo.x * wi.x + wo.y * wi.y) / (so * si), -1), 1) : 0;
    a.alpha = fmax(to, ti);
    a.beta = fmin(to, ti);
    a.tan_beta = to < ti ? so / wo.z : si / wi.z;
    a.sin_alpha = fmax(so, si);
    return a;
}

// The qualitative model, eq. 30.
static inline double oren_nayar_qualitative(const struct oren_nayar_angles *a, double sigma) {
    const double s2 = sigma * sigma;
    return 1 - 0.5 * s2 / (s2 + 0.33) +
           0.45 * s2 / (s2 + 0.09) * fmax(a->cos_phi, 0) * a->sin_alpha * a->tan_beta;
}

// The full model, eq. 27 and 28: light reflected once. Where sigma is great, the published sum
// falls below 0 far from the light; it ends at 0 here.
static inline double oren_nayar_once(const struct oren_nayar_angles *a, double sigma) {
    const double s2 = sigma * sigma, b = 2 * a->beta / M_PI;
    const double ab = 4 * a->alpha * a->beta / (M_PI * M_PI);
    const double c1 = 1 - 0.5 * s2 / (s2 + 0.33);
    const double c2 = 0.45 * s2 / (s2 + 0.09) *
                      (a->sin_alpha - (a->cos_phi < 0 ? b * b * b : 0));
    const double c3 = 0.125 * s2 / (s2 + 0.09) * ab * ab;
    return fmax(c1 + a->cos_phi * c2 * a->tan_beta +
                    (1 - fabs(a->cos_phi)) * c3 * tan(0.5 * (a->alpha + a->beta)), 0);
}

// The full model, eq. 29: light reflected twice, to be multiplied by one more rho.
static inline double oren_nayar_twice(const struct oren_nayar_angles *a, double sigma) {
    const double s2 = sigma * sigma, b = 2 * a->beta / M_PI;
    return 0.17 * s2 / (s2 + 0.13) * (1 - a->cos_phi * b * b);
}
