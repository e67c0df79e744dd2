// SPDX-License-Identifier: Apache-2.0
// Doubles of half of the lanes of wide.h, which fill as large a register. Masks have all bits of a
// lane set, or none.
#pragma once

#include "math/wide.h"

enum { WIDE_HALVES = WIDE_LANES / WIDE_HALF };

typedef double wide_double __attribute__((vector_size(8 * WIDE_HALF)));
typedef int64_t wide_long __attribute__((vector_size(8 * WIDE_HALF)));

// Of the lower lanes (half 0) or the upper ones.
static inline wide_double wide_half_to_double(wide v, int half) {
    typedef float narrow __attribute__((vector_size(4 * WIDE_HALF)));
    const narrow h = half ? __builtin_shufflevector(v, v, WIDE_UPPER)
                          : __builtin_shufflevector(v, v, WIDE_LOWER);
    return __builtin_convertvector(h, wide_double);
}

static inline wide wide_from_doubles(wide_double a, wide_double b) {
    typedef float narrow __attribute__((vector_size(4 * WIDE_HALF)));
    const narrow lower = __builtin_convertvector(a, narrow), upper = __builtin_convertvector(b, narrow);
    return __builtin_shufflevector(lower, upper, WIDE_LOWER, WIDE_UPPER);
}

static inline uint32_t wide_long_bits(wide_long m) {
#if defined(__AVX512F__)
    return _mm512_test_epi64_mask((__m512i)m, (__m512i)m);
#elif defined(__AVX__)
    return (uint32_t)_mm256_movemask_pd((__m256d)m);
#else
    uint32_t bits = 0;
    for (int i = 0; i < WIDE_HALF; i++)
        bits |= (uint32_t)(m[i] & 1) << i;
    return bits;
#endif
}

static inline wide_double wide_double_select(wide_long m, wide_double a, wide_double b) {
#if defined(__AVX__) && !defined(__AVX512F__)
    return (wide_double)_mm256_blendv_pd((__m256d)b, (__m256d)a, (__m256d)m);
#else
    return (wide_double)(((wide_long)a & m) | ((wide_long)b & ~m));
#endif
}

static inline wide_double wide_double_sqrt(wide_double a) {
#if defined(__AVX512F__)
    return (wide_double)_mm512_sqrt_pd((__m512d)a);
#elif defined(__AVX__)
    return (wide_double)_mm256_sqrt_pd((__m256d)a);
#else
    for (int i = 0; i < WIDE_HALF; i++)
        a[i] = sqrt(a[i]);
    return a;
#endif
}

static inline wide_double wide_double_copysign(wide_double magnitude, wide_double sign) {
    return (wide_double)(((wide_long)magnitude & INT64_MAX) | ((wide_long)sign & INT64_MIN));
}

static inline wide_double wide_double_of(double v) {
    return v - (wide_double){0};
}

// As fmin and fmax, but that a NaN in a gives b.
static inline wide_double wide_double_min(wide_double a, wide_double b) {
    return wide_double_select(a < b, a, b);
}

static inline wide_double wide_double_max(wide_double a, wide_double b) {
    return wide_double_select(a > b, a, b);
}

static inline wide_double wide_double_gather(const double *from, wide_long i) {
    wide_double v = {0};
    for (int k = 0; k < WIDE_HALF; k++)
        v[k] = from[i[k]];
    return v;
}

// The lanes of a half whose bits are set.
static inline wide_long wide_half_mask(uint32_t bits, int half) {
    const wide_long lane = {WIDE_LOWER};
    return (((int64_t)(bits >> (WIDE_HALF * half)) & (int64_t)1 << lane) != 0);
}
