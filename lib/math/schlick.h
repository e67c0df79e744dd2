// SPDX-License-Identifier: Apache-2.0
// Schlick 1994, An Inexpensive BRDF Model for Physically-based Rendering: rational functions of
// roughness r and isotropy p,
//
//     Z = r / (1 + r t^2 - t^2)^2,  A = sqrt(p / (p^2 - p^2 w^2 + w^2)),  G(v) = v / (r - r v + v)
//     f = G(cos_o) G(cos_i) Z A / (4 pi cos_o cos_i) + (1 - G(cos_o) G(cos_i)) / pi
//
// times the Fresnel reflectance; t = cos_h, w the cosine of h's azimuth from x. Z / pi is the
// distribution that later became known as GGX, of roughness sqrt(r). The mean of A over the azimuth
// is sqrt(p) / agm(1, p), at most 1.
#pragma once

#include "math/half_vector.h"

static inline double schlick_Z(struct direction h, double r) {
    const double q = r * h.z * h.z + h.x * h.x + h.y * h.y;
    return r / (q * q);
}

static inline double schlick_A(struct direction h, double p) {
    const double xx = h.x * h.x, yy = h.y * h.y;
    return xx + yy > 0 ? sqrt(p * (xx + yy) / (p * p * yy + xx)) : 1;
}

static inline double schlick_G(double v, double r) {
    return v / (r - r * v + v);
}

// The directional term, without the Fresnel reflectance.
static inline double schlick_directional(const struct half_vector *v, double r, double p) {
    return schlick_Z(v->h, r) * schlick_A(v->h, p) /
           (4 * M_PI * (r + v->cos_o * (1 - r)) * (r + v->cos_i * (1 - r)));
}

// What grooves send back and forth, as a diffuse share: f of it is this over pi.
static inline double schlick_diffuse_share(double cos_o, double cos_i, double r) {
    return 1 - schlick_G(cos_o, r) * schlick_G(cos_i, r);
}

// Azimuths have the density A: an incomplete elliptic integral of the first kind, inverted by
// descending Landen steps of the arithmetic-geometric mean (Abramowitz and Stegun 1964, 16.4).
enum { SCHLICK_STEPS = 6 };

struct schlick_azimuth {
    double ratio[SCHLICK_STEPS]; // c_n / a_n
    double mean;                 // of A
};

static inline struct schlick_azimuth schlick_azimuth_make(double p) {
    struct schlick_azimuth z;
    double a = 1, b = p;
    for (int i = 0; i < SCHLICK_STEPS; i++) {
        const double mean = 0.5 * (a + b);
        z.ratio[i] = 0.5 * (a - b) / mean;
        b = sqrt(a * b);
        a = mean;
    }
    z.mean = sqrt(p) / a;
    return z;
}

static inline double schlick_azimuth_sample(const struct schlick_azimuth *z, double u) {
    double phi = ldexp(2 * M_PI * u, SCHLICK_STEPS);
    for (int i = SCHLICK_STEPS - 1; i >= 0; i--)
        phi = 0.5 * (phi + asin(z->ratio[i] * sin(phi)));
    return phi;
}

// Density of schlick_half_sample.
static inline double schlick_pdf_h(struct direction h, double r, double p,
                                   const struct schlick_azimuth *z) {
    return schlick_Z(h, r) * schlick_A(h, p) * h.z / (M_PI * z->mean);
}

// A half vector; u, v in [0, 1).
static inline struct direction schlick_half_sample(double r, const struct schlick_azimuth *z,
                                                   double u, double v) {
    const double slope = sqrt(r * u / (1 - u)), phi = schlick_azimuth_sample(z, v);
    return direction_of(slope * cos(phi), slope * sin(phi), 1);
}
