// SPDX-License-Identifier: Apache-2.0
// elementary.h for all lanes, operation by operation.
#pragma once

#include "math/wide.h"

static inline wide wide_rint(wide a) {
#if defined(__AVX512F__)
    return (wide)_mm512_roundscale_ps((__m512)a, _MM_FROUND_CUR_DIRECTION);
#elif defined(__AVX__)
    return (wide)_mm256_round_ps((__m256)a, _MM_FROUND_CUR_DIRECTION);
#else
    for (int i = 0; i < WIDE_LANES; i++)
        a[i] = rintf(a[i]);
    return a;
#endif
}

static inline wide wide_exp(wide x) {
    const wide_mask some = x > -87;
    x = wide_min(wide_max(x, wide_of(-87)), wide_of(88));
    const wide n = wide_rint(x * 1.44269504f);
    const wide r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
    const wide r2 = r * r;
    const wide p = (1.9875691500e-4f * r + 1.3981999507e-3f) * (r2 * r2) +
                   (8.3334519073e-3f * r + 4.1665795894e-2f) * r2 +
                   (1.6666665459e-1f * r + 5.0000001201e-1f);
    const wide scale = (wide)((__builtin_convertvector(n, wide_int) + 127) << 23);
    return (wide)((wide_int)((p * r2 + r + 1) * scale) & some);
}

static inline wide wide_log(wide x) {
    wide_int bits = (wide_int)x;
    const wide_int e = (bits - 0x3f3504f3) >> 23;
    bits -= e * (1 << 23);
    const wide m = (wide)bits - 1;
    const wide m2 = m * m, m4 = m2 * m2;
    const wide p = 7.0376836292e-2f * (m4 * m4) +
                   ((-1.1514610310e-1f * m + 1.1676998740e-1f) * m2 +
                    (-1.2420140846e-1f * m + 1.4249322787e-1f)) * m4 +
                   ((-1.6668057665e-1f * m + 2.0000714765e-1f) * m2 +
                    (-2.4999993993e-1f * m + 3.3333331174e-1f));
    const wide k = __builtin_convertvector(e, wide);
    return (m + (p * m * m2 - k * 2.12194440e-4f - 0.5f * m2)) + k * 0.693359375f;
}

static inline void wide_sincos_octant(wide x, wide *sine, wide *cosine) {
    const wide x2 = x * x;
    *sine = x + x * x2 * (-1.6666654611e-1f + x2 * (8.3321608736e-3f - x2 * 1.9515295891e-4f));
    *cosine = 1 - 0.5f * x2 +
              x2 * x2 * (4.166664568298827e-2f +
                         x2 * (-1.388731625493765e-3f + x2 * 2.443315711809948e-5f));
}

static inline void wide_sincos_turn(wide u, wide *sine, wide *cosine) {
    const wide q = wide_rint(4 * u);
    wide s, c;
    wide_sincos_octant((u - 0.25f * q) * TWO_PI, &s, &c);
    const wide_int quadrant = __builtin_convertvector(q, wide_int) & 3;
    const wide_mask odd = (quadrant & 1) != 0;
    *sine = wide_negate((quadrant & 2) != 0, wide_select(odd, c, s));
    *cosine = wide_negate(((quadrant + 1) & 2) != 0, wide_select(odd, s, c));
}
