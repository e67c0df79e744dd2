// SPDX-License-Identifier: Apache-2.0
// Sixteen numbers at once: the lanes of a packet, one value of each.
//
// The same formula as for one number, in the same order, gives the same bits in every lane, whatever
// the other lanes hold. Masks have all bits of a lane set, or none. Native with AVX-512, pieces of
// smaller vectors elsewhere.
#pragma once

#include <string.h>

#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "math/vec.h"

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

// Sixteen bytes as numbers.
static inline wide wide_of_bytes(const uint8_t v[WIDE_LANES]) {
#if defined(__AVX512F__)
    return (wide)_mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128((const void *)v)));
#else
    wide w;
    for (int i = 0; i < WIDE_LANES; i++)
        w[i] = v[i];
    return w;
#endif
}

static inline wide wide_of_signed_bytes(const int8_t v[WIDE_LANES]) {
#if defined(__AVX512F__)
    return (wide)_mm512_cvtepi32_ps(_mm512_cvtepi8_epi32(_mm_loadu_si128((const void *)v)));
#else
    wide w;
    for (int i = 0; i < WIDE_LANES; i++)
        w[i] = v[i];
    return w;
#endif
}

// The mask as it is. Where masks are joined that come straight from comparisons, clang joins one byte
// a lane and packs and unpacks for it: three times the instructions. What passes here it leaves alone.
static inline wide_mask wide_whole(wide_mask m) {
#if defined(__clang__) && defined(__AVX__) && !defined(__AVX512F__)
    __m256 *half = (__m256 *)&m;
    __asm__("" : "+x"(half[0]), "+x"(half[1]));
#endif
    return m;
}

// Of comparisons: a & b, and a | b.
static inline wide_mask wide_both(wide_mask a, wide_mask b) {
    return wide_whole(a) & wide_whole(b);
}

static inline wide_mask wide_either(wide_mask a, wide_mask b) {
    return wide_whole(a) | wide_whole(b);
}

// One bit a lane.
static inline uint32_t wide_bits(wide_mask m) {
#if defined(__AVX512F__)
    return _mm512_test_epi32_mask((__m512i)m, (__m512i)m);
#elif defined(__AVX__)
    const __m256 *half = (const __m256 *)&m;
    return (uint32_t)_mm256_movemask_ps(half[0]) | (uint32_t)_mm256_movemask_ps(half[1]) << 8;
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

static inline struct wide3 wide3_of(vec3 a) {
    return (struct wide3){wide_of(a[0]), wide_of(a[1]), wide_of(a[2])};
}

static inline vec3 wide3_lane(const struct wide3 *a, int i) {
    return v3(a->x[i], a->y[i], a->z[i]);
}

static inline void wide3_set_lane(struct wide3 *a, int i, vec3 v) {
    a->x[i] = v[0];
    a->y[i] = v[1];
    a->z[i] = v[2];
}

static inline struct wide3 wide3_select(wide_mask m, struct wide3 a, struct wide3 b) {
    return (struct wide3){wide_select(m, a.x, b.x), wide_select(m, a.y, b.y), wide_select(m, a.z, b.z)};
}

static inline struct wide3 wide3_add(struct wide3 a, struct wide3 b) {
    return (struct wide3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct wide3 wide3_sub(struct wide3 a, struct wide3 b) {
    return (struct wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct wide3 wide3_scale(wide s, struct wide3 a) {
    return (struct wide3){s * a.x, s * a.y, s * a.z};
}

static inline struct wide3 wide3_abs(struct wide3 a) {
    return (struct wide3){wide_abs(a.x), wide_abs(a.y), wide_abs(a.z)};
}

// -a where the mask is set, a elsewhere.
static inline wide wide_negate(wide_mask m, wide a) {
    return (wide)((wide_int)a ^ (m & INT32_MIN));
}

static inline struct wide3 wide3_negate(wide_mask m, struct wide3 a) {
    return (struct wide3){wide_negate(m, a.x), wide_negate(m, a.y), wide_negate(m, a.z)};
}

#if defined(__AVX__) && !defined(__AVX512F__)
// a, b, c, d as rows of four by four matrices side by side, to their columns and back.
static inline void wide_transpose8(__m256 a, __m256 b, __m256 c, __m256 d, __m256 out[4]) {
    const __m256d ab_lo = (__m256d)_mm256_unpacklo_ps(a, b), ab_hi = (__m256d)_mm256_unpackhi_ps(a, b);
    const __m256d cd_lo = (__m256d)_mm256_unpacklo_ps(c, d), cd_hi = (__m256d)_mm256_unpackhi_ps(c, d);
    out[0] = (__m256)_mm256_unpacklo_pd(ab_lo, cd_lo);
    out[1] = (__m256)_mm256_unpackhi_pd(ab_lo, cd_lo);
    out[2] = (__m256)_mm256_unpacklo_pd(ab_hi, cd_hi);
    out[3] = (__m256)_mm256_unpackhi_pd(ab_hi, cd_hi);
}

// Eight lanes of wide_gather4 and wide_scatter4.
static inline void wide_gather8(const float *const row[8], wide out[4], int half) {
    __m256 r[4];
    for (int k = 0; k < 4; k++)
        r[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row[k])),
                                    _mm_loadu_ps(row[k + 4]), 1);
    wide_transpose8(r[0], r[1], r[2], r[3], r);
    for (int k = 0; k < 4; k++)
        ((__m256 *)&out[k])[half] = r[k];
}

static inline void wide_scatter8(const wide in[4], float *const row[8], int half) {
    __m256 r[4];
    for (int k = 0; k < 4; k++)
        r[k] = ((const __m256 *)&in[k])[half];
    wide_transpose8(r[0], r[1], r[2], r[3], r);
    for (int k = 0; k < 4; k++) {
        _mm_storeu_ps(row[k], _mm256_castps256_ps128(r[k]));
        _mm_storeu_ps(row[k + 4], _mm256_extractf128_ps(r[k], 1));
    }
}
#endif

// Four numbers that lie together in memory for each lane: out[k] lane i is row[i][k].
static inline void wide_gather4(const float *const row[WIDE_LANES], wide out[4]) {
#if defined(__AVX512F__)
    __m512 r[4];
    for (int k = 0; k < 4; k++) {
        r[k] = _mm512_castps128_ps512(_mm_loadu_ps(row[k]));
        r[k] = _mm512_insertf32x4(r[k], _mm_loadu_ps(row[k + 4]), 1);
        r[k] = _mm512_insertf32x4(r[k], _mm_loadu_ps(row[k + 8]), 2);
        r[k] = _mm512_insertf32x4(r[k], _mm_loadu_ps(row[k + 12]), 3);
    }
    const __m512d a = (__m512d)_mm512_unpacklo_ps(r[0], r[1]);
    const __m512d b = (__m512d)_mm512_unpackhi_ps(r[0], r[1]);
    const __m512d c = (__m512d)_mm512_unpacklo_ps(r[2], r[3]);
    const __m512d d = (__m512d)_mm512_unpackhi_ps(r[2], r[3]);
    out[0] = (wide)_mm512_unpacklo_pd(a, c);
    out[1] = (wide)_mm512_unpackhi_pd(a, c);
    out[2] = (wide)_mm512_unpacklo_pd(b, d);
    out[3] = (wide)_mm512_unpackhi_pd(b, d);
#elif defined(__AVX__)
    for (int half = 0; half < 2; half++)
        wide_gather8(row + 8 * half, out, half);
#else
    for (int i = 0; i < WIDE_LANES; i++)
        for (int k = 0; k < 4; k++)
            out[k][i] = row[i][k];
#endif
}

// The way back; rows do not overlap, except that lanes nobody wants may share one.
static inline void wide_scatter4(const wide in[4], float *const row[WIDE_LANES]) {
#if defined(__AVX512F__)
    const __m512d a = (__m512d)_mm512_unpacklo_ps((__m512)in[0], (__m512)in[1]);
    const __m512d b = (__m512d)_mm512_unpackhi_ps((__m512)in[0], (__m512)in[1]);
    const __m512d c = (__m512d)_mm512_unpacklo_ps((__m512)in[2], (__m512)in[3]);
    const __m512d d = (__m512d)_mm512_unpackhi_ps((__m512)in[2], (__m512)in[3]);
    const __m512 r[4] = {(__m512)_mm512_unpacklo_pd(a, c), (__m512)_mm512_unpackhi_pd(a, c),
                         (__m512)_mm512_unpacklo_pd(b, d), (__m512)_mm512_unpackhi_pd(b, d)};
    for (int k = 0; k < 4; k++) {
        _mm_storeu_ps(row[k], _mm512_castps512_ps128(r[k]));
        _mm_storeu_ps(row[k + 4], _mm512_extractf32x4_ps(r[k], 1));
        _mm_storeu_ps(row[k + 8], _mm512_extractf32x4_ps(r[k], 2));
        _mm_storeu_ps(row[k + 12], _mm512_extractf32x4_ps(r[k], 3));
    }
#elif defined(__AVX__)
    for (int half = 0; half < 2; half++)
        wide_scatter8(in, row + 8 * half, half);
#else
    for (int i = 0; i < WIDE_LANES; i++)
        for (int k = 0; k < 4; k++)
            row[i][k] = in[k][i];
#endif
}
