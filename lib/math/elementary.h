// SPDX-License-Identifier: Apache-2.0
// exp, log, sine and cosine in single precision, inline: the library's take longer than a whole
// evaluation of a material, and differ between systems. Coefficients of Cephes (Moshier 1992),
// polynomials by Estrin's scheme, whose chain of dependent operations is short.
#pragma once

#include <stdint.h>
#include <string.h>

#include "math/vec.h"

// e^x to 2 ulp for x in [-87, 88]; 0 below, e^88 above. NaN gives 0.
static inline float fast_exp(float x) {
    if (!(x > -87))
        return 0;
    x = minf(x, 88);
    const float n = rintf(x * 1.44269504f);
    const float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
    const float r2 = r * r;
    const float p = (1.9875691500e-4f * r + 1.3981999507e-3f) * (r2 * r2) +
                    (8.3334519073e-3f * r + 4.1665795894e-2f) * r2 +
                    (1.6666665459e-1f * r + 5.0000001201e-1f);
    const int32_t bits = ((int32_t)n + 127) << 23;
    float scale;
    memcpy(&scale, &bits, sizeof scale);
    return (p * r2 + r + 1) * scale;
}

// Natural logarithm to 2 ulp for normal x > 0.
static inline float fast_log(float x) {
    int32_t bits;
    memcpy(&bits, &x, sizeof bits);
    // the mantissa to [sqrt 1/2, sqrt 2)
    const int32_t e = (bits - 0x3f3504f3) >> 23;
    bits -= e * (1 << 23);
    float m;
    memcpy(&m, &bits, sizeof m);
    m -= 1;
    const float m2 = m * m, m4 = m2 * m2;
    const float p = 7.0376836292e-2f * (m4 * m4) +
                    ((-1.1514610310e-1f * m + 1.1676998740e-1f) * m2 +
                     (-1.2420140846e-1f * m + 1.4249322787e-1f)) * m4 +
                    ((-1.6668057665e-1f * m + 2.0000714765e-1f) * m2 +
                     (-2.4999993993e-1f * m + 3.3333331174e-1f));
    const float k = (float)e;
    return (m + (p * m * m2 - k * 2.12194440e-4f - 0.5f * m2)) + k * 0.693359375f;
}

// Sine and cosine of an angle of [-pi/4, pi/4], to 2 ulp.
static inline void sincos_octant(float x, float *sine, float *cosine) {
    const float x2 = x * x;
    *sine = x + x * x2 * (-1.6666654611e-1f + x2 * (8.3321608736e-3f - x2 * 1.9515295891e-4f));
    *cosine = 1 - 0.5f * x2 +
              x2 * x2 * (4.166664568298827e-2f +
                         x2 * (-1.388731625493765e-3f + x2 * 2.443315711809948e-5f));
}

// Sine and cosine of a turn (2 pi u), u in [-1, 1].
static inline void sincos_turn(float u, float *sine, float *cosine) {
    const float q = rintf(4 * u);
    float s, c;
    sincos_octant((u - 0.25f * q) * TWO_PI, &s, &c);
    const int quadrant = (int)q & 3;
    const float a = quadrant & 1 ? c : s, b = quadrant & 1 ? s : c;
    *sine = quadrant & 2 ? -a : a;
    *cosine = (quadrant + 1) & 2 ? -b : b;
}
