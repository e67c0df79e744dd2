// SPDX-License-Identifier: Apache-2.0
// Eight doubles at once: half of the lanes of wide.h. Masks have all bits of a lane set, or none.
#pragma once

#include "math/wide.h"

typedef double wide_double __attribute__((vector_size(64)));
typedef int64_t wide_long __attribute__((vector_size(64)));

// Lanes 0 to 7 (half 0) or 8 to 15.
static inline wide_double wide_half_to_double(wide v, int half) {
    typedef float eight __attribute__((vector_size(32)));
    const eight h = half ? __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15)
                         : __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_convertvector(h, wide_double);
}

static inline wide wide_from_doubles(wide_double a, wide_double b) {
    typedef float eight __attribute__((vector_size(32)));
    const eight lower = __builtin_convertvector(a, eight), upper = __builtin_convertvector(b, eight);
    return __builtin_shufflevector(lower, upper, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14,
                                   15);
}

static inline uint32_t wide_long_bits(wide_long m) {
#if defined(__AVX512F__)
    return _mm512_test_epi64_mask((__m512i)m, (__m512i)m);
#elif defined(__AVX__)
    const __m256d *half = (const __m256d *)&m;
    return (uint32_t)_mm256_movemask_pd(half[0]) | (uint32_t)_mm256_movemask_pd(half[1]) << 4;
#else
    uint32_t bits = 0;
    for (int i = 0; i < 8; i++)
        bits |= (uint32_t)(m[i] & 1) << i;
    return bits;
#endif
}

static inline wide_double wide_double_select(wide_long m, wide_double a, wide_double b) {
    return (wide_double)(((wide_long)a & m) | ((wide_long)b & ~m));
}

static inline wide_double wide_double_sqrt(wide_double a) {
#if defined(__AVX512F__)
    return (wide_double)_mm512_sqrt_pd((__m512d)a);
#else
    for (int i = 0; i < 8; i++)
        a[i] = sqrt(a[i]);
    return a;
#endif
}

static inline wide_double wide_double_copysign(wide_double magnitude, wide_double sign) {
    return (wide_double)(((wide_long)magnitude & INT64_MAX) | ((wide_long)sign & INT64_MIN));
}

static inline wide_double wide_double_of(double v) {
    return (wide_double){v, v, v, v, v, v, v, v};
}

// As fmin and fmax, but that a NaN in a gives b.
static inline wide_double wide_double_min(wide_double a, wide_double b) {
    return wide_double_select(a < b, a, b);
}

static inline wide_double wide_double_max(wide_double a, wide_double b) {
    return wide_double_select(a > b, a, b);
}

static inline wide_double wide_double_gather(const double *from, wide_long i) {
    return (wide_double){from[i[0]], from[i[1]], from[i[2]], from[i[3]],
                         from[i[4]], from[i[5]], from[i[6]], from[i[7]]};
}

// The lanes of a half whose bits are set.
static inline wide_long wide_half_mask(uint32_t bits, int half) {
    const wide_long lane = {1, 2, 4, 8, 16, 32, 64, 128};
    return (((int64_t)(bits >> (8 * half)) & lane) != 0);
}
