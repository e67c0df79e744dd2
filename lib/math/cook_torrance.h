// SPDX-License-Identifier: Apache-2.0
// Cook and Torrance 1982, A Reflectance Model for Computer Graphics: Beckmann's slopes, V-shaped
// grooves and the Fresnel reflectance F of a complex index,
//
//     f = F D G / (4 cos_o cos_i)
//
// with D normalised over projected area. The paper has D without 1/pi and pi in place of 4: its f
// is 4 times this one, and reflects up to 4 times what arrives.
#pragma once

#include "math/beckmann.h"
#include "math/half_vector.h"

// Without F.
static inline double cook_torrance_brdf(const struct half_vector *v, const struct beckmann *b) {
    return beckmann_D(b, v->h) * v_cavity(v) / (4 * v->cos_o * v->cos_i);
}

// Unpolarised reflectance of the complex index eta + i k; fresnel_conductor of math/fresnel.h in
// double precision, derived there.
static inline double conductor_reflectance(double cos_d, double eta, double k) {
    const double c = cos_d, c2 = c * c, s2 = fmax(1 - c2, 0);
    const double m = (eta - 1) * (eta + 1) - k * k + c2, ek2 = eta * eta * k * k;
    const double norm = sqrt(m * m + 4 * ek2), big = 0.5 * (norm + fabs(m));
    const double small = big > 0 ? ek2 / big : 0;
    const double a2 = m >= 0 ? big : small, b2 = m >= 0 ? small : big, a = sqrt(a2);
    const double am = a - c, ap = a + c, pm = c * a - s2, pp = c * a + s2;
    const double r_s = (am * am + b2) / fmax(ap * ap + b2, 1e-300);
    const double r_p = (pm * pm + c2 * b2) / fmax(pp * pp + c2 * b2, 1e-300);
    return fmin(0.5 * r_s * (1 + r_p), 1);
}
