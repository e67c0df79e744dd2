// SPDX-License-Identifier: Apache-2.0
// Sixteen numbers at once: the lanes of a packet, one value of each.
//
// The same formula as for one number, in the same order, gives the same bits in every lane, whatever
// the other lanes hold. Masks have all bits of a lane set, or none. Native with AVX-512, pieces of
// smaller vectors elsewhere.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

enum { WIDE_LANES = 16 };

typedef float wide __attribute__((vector_size(64)));
typedef int32_t wide_int __attribute__((vector_size(64)));
typedef uint32_t wide_uint __attribute__((vector_size(64)));
typedef wide_int wide_mask;

struct wide3 {
    wide x, y, z;
};

static inline wide wide_of(float v) {
    return (wide){v, v, v, v, v, v, v, v, v, v, v, v, v, v, v, v};
}

static inline wide_int wide_int_of(int32_t v) {
    return (wide_int){v, v, v, v, v, v, v, v, v, v, v, v, v, v, v, v};
}

static inline wide wide_load(const float v[WIDE_LANES]) {
    wide w;
    memcpy(&w, v, sizeof w);
    return w;
}

// One bit a lane.
static inline uint32_t wide_bits(wide_mask m) {
#if defined(__AVX512F__)
    return _mm512_test_epi32_mask((__m512i)m, (__m512i)m);
#else
    uint32_t bits = 0;
    for (int i = 0; i < WIDE_LANES; i++)
        bits |= (uint32_t)(m[i] & 1) << i;
    return bits;
#endif
}

static inline bool wide_any(wide_mask m) {
    return wide_bits(m) != 0;
}

static inline wide_mask wide_mask_of(uint32_t bits) {
    const wide_int lane = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768};
    return (wide_int_of((int32_t)bits) & lane) != 0;
}

// Lanes of a where the mask is set, of b elsewhere.
static inline wide_int wide_int_select(wide_mask m, wide_int a, wide_int b) {
    return (a & m) | (b & ~m);
}

static inline wide wide_select(wide_mask m, wide a, wide b) {
    return (wide)wide_int_select(m, (wide_int)a, (wide_int)b);
}

// As minf and maxf: a NaN in a gives b.
static inline wide wide_min(wide a, wide b) {
#if defined(__AVX512F__)
    return (wide)_mm512_min_ps((__m512)a, (__m512)b);
#else
    return wide_select(a < b, a, b);
#endif
}

static inline wide wide_max(wide a, wide b) {
#if defined(__AVX512F__)
    return (wide)_mm512_max_ps((__m512)a, (__m512)b);
#else
    return wide_select(a > b, a, b);
#endif
}

static inline wide wide_abs(wide a) {
    return (wide)((wide_int)a & wide_int_of(0x7fffffff));
}

static inline wide wide_sqrt(wide a) {
#if defined(__AVX512F__)
    return (wide)_mm512_sqrt_ps((__m512)a);
#else
    for (int i = 0; i < WIDE_LANES; i++)
        a[i] = sqrtf(a[i]);
    return a;
#endif
}

static inline wide wide_dot(struct wide3 a, struct wide3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct wide3 wide_cross(struct wide3 a, struct wide3 b) {
    return (struct wide3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
