// SPDX-License-Identifier: Apache-2.0
// The anisotropic Beckmann model with a free exponent in place of shadowing and masking (Kurt,
// Szirmay-Kalos and Krivanek 2010, An Anisotropic BRDF Model for Fitting and Monte Carlo
// Rendering), and its lobe for thin sheets (Muehlbacher 2012, Real-time Rendering of Measured
// Materials, eq. 3.5), where wt' is the direction below, mirrored at the surface:
//
//     f_r(wo, wi) = F(cos_d) D(h) / (4 cos_d (cos_o cos_i)^alpha)
//     f_t(wo, wt) = (1 - F(cos_d)) D(h) / (4 cos_d (cos_o cos_t)^alpha),  h of wo and wt'
//
// F is Schlick's, from r0. Both are reciprocal. alpha = 0 loses light towards grazing angles; alpha
// = 1/2 of a smooth surface is free of loss; above, more light leaves than arrives, without bound.
#pragma once

#include "math/beckmann.h"
#include "math/half_vector.h"

struct kskk {
    struct beckmann slopes;
    double r0;    // reflectance at normal incidence, 0..1
    double alpha; // 0..1
    bool transmits;
};

// f of one lobe, with wi on the upper side (mirrored for transmission).
static inline double kskk_brdf(const struct kskk *k, const struct half_vector *v) {
    const double F = schlick_fresnel(v->cos_d, k->r0);
    return (k->transmits ? 1 - F : F) * beckmann_D(&k->slopes, v->h) /
           (4 * v->cos_d * pow(v->cos_o * v->cos_i, k->alpha));
}

// Density of wi when h is drawn by beckmann_sample.
static inline double kskk_pdf(const struct kskk *k, const struct half_vector *v) {
    return beckmann_D(&k->slopes, v->h) * v->cos_h / (4 * v->cos_d);
}

// f cos_i / pdf, formed without D.
static inline double kskk_weight(const struct kskk *k, const struct half_vector *v) {
    const double F = schlick_fresnel(v->cos_d, k->r0);
    return (k->transmits ? 1 - F : F) * v->cos_i /
           (v->cos_h * pow(v->cos_o * v->cos_i, k->alpha));
}

// What the lobe reflects (or transmits) of all that arrives, seen from a direction with that
// cosine and azimuth: the integral of f cos_i. Without bound for alpha > 1/2 towards cos_o = 0.
// To 1e-5 of itself.
double kskk_albedo(const struct kskk *k, double cos_o, double phi_o);
