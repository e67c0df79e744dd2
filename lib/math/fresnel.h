// SPDX-License-Identifier: Apache-2.0
// Fresnel reflectance of smooth interfaces, unpolarised.
//
// Conventions: eta is the index of the far side over that of the near side (where the light comes
// from); cos_i >= 0 is on the near side. All forms are free of cancellation: F is exactly 0 at
// eta = 1 (or eta = 1, k = 0), 1 to rounding at grazing incidence otherwise, and never leaves
// [0, 1].
#pragma once

#include "math/vec.h"

// Dielectric. *cos_t is the cosine of the refracted direction, 0 where all is reflected.
//
// With q = eta cos_t = sqrt(cos_i^2 + eta^2 - 1), the amplitudes (c - q)/(c + q) and
// (q - eta^2 c)/(q + eta^2 c) are expanded by their denominators, which leaves the small factor
// eta^2 - 1 explicit.
static inline float fresnel_dielectric(float cos_i, float eta, float *cos_t) {
    const float d = (eta - 1) * (eta + 1); // eta^2 - 1
    const float c2 = cos_i * cos_i;
    if (d == 0) {
        *cos_t = cos_i;
        return 0;
    }
    const float q2 = c2 + d;
    if (q2 <= 0) {
        *cos_t = 0;
        return 1;
    }
    const float q = sqrtf(q2), e2 = eta * eta;
    *cos_t = minf(q / eta, 1);
    const float s = 1 / (cos_i + q), p = 1 / (q + e2 * cos_i);
    const float r_s = d * s * s;
    const float r_p = d * (1 - c2 * (1 + e2)) * p * p;
    return minf(0.5f * (r_s * r_s + r_p * r_p), 1);
}

// Conductor of complex index eta + i k, lane by lane (Moeller 1988, Optics; as sums of squares:
// (a - c)^2 + b^2 with (a + i b)^2 = (eta + i k)^2 - sin^2).
static inline spectrum fresnel_conductor(float cos_i, spectrum eta, spectrum k) {
    const float c = cos_i, c2 = c * c, s2 = maxf(1 - c2, 0);
    const spectrum m = (eta - 1) * (eta + 1) - k * k + c2; // Re (a + i b)^2
    const spectrum ek = eta * k, ek2 = ek * ek;
    spectrum f;
    for (int i = 0; i < 4; i++) {
        const float norm = sqrtf(m[i] * m[i] + 4 * ek2[i]); // a^2 + b^2
        const float big = 0.5f * (norm + fabsf(m[i]));
        const float small = ek2[i] / maxf(big, 1e-30f); // the other one, since a b = eta k
        const float a2 = m[i] >= 0 ? big : small, b2 = m[i] >= 0 ? small : big;
        const float a = sqrtf(a2);
        const float am = a - c, ap = a + c, pm = c * a - s2, pp = c * a + s2;
        const float r_s = (am * am + b2) / maxf(ap * ap + b2, 1e-30f);
        const float r_p = (pm * pm + c2 * b2) / maxf(pp * pp + c2 * b2, 1e-30f);
        f[i] = minf(0.5f * r_s * (1 + r_p), 1);
    }
    f[3] = 0;
    return f;
}

// 2 * integral of F(c) c dc over [0, 1]: what a dielectric reflects of diffuse light, to 1e-7; and
// what it transmits, without the cancellation of 1 - reflected where that is little (small eta).
double fresnel_dielectric_average(double eta);
double fresnel_dielectric_transmitted(double eta);
