// SPDX-License-Identifier: Apache-2.0
// WIDE_LANES numbers at once, one of each lane: as many as a register of the target holds, sixteen with
// AVX-512, eight with AVX2, and two registers of four elsewhere. Wider vectors than the target has,
// gcc takes to pieces in memory.
//
// The same formula as for one number, in the same order, gives the same bits in every lane, whatever
// the other lanes hold and however many there are: what sums or compares across lanes has a number
// of its own to go by. Masks have all bits of a lane set, or none.
#pragma once

#include <string.h>

#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "math/vec.h"

// How many, and for __builtin_shufflevector the lanes by halves, those 1, 2, 4 and 8 before each, the
// next of each, and each of the lower half three times.
#if defined(__AVX512F__)
enum { WIDE_LANES = 16 };
#define WIDE_LOWER 0, 1, 2, 3, 4, 5, 6, 7
#define WIDE_UPPER 8, 9, 10, 11, 12, 13, 14, 15
#define WIDE_BEFORE_1 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14
#define WIDE_BEFORE_2 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13
#define WIDE_BEFORE_4 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11
#define WIDE_BEFORE_8 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7
#define WIDE_NEXT 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 15
#define WIDE_THRICE_0 0, 0, 0, 1, 1, 1, 2, 2
#define WIDE_THRICE_1 2, 3, 3, 3, 4, 4, 4, 5
#define WIDE_THRICE_2 5, 5, 6, 6, 6, 7, 7, 7
#else
enum { WIDE_LANES = 8 };
#define WIDE_LOWER 0, 1, 2, 3
#define WIDE_UPPER 4, 5, 6, 7
#define WIDE_BEFORE_1 0, 0, 1, 2, 3, 4, 5, 6
#define WIDE_BEFORE_2 0, 0, 0, 1, 2, 3, 4, 5
#define WIDE_BEFORE_4 0, 0, 0, 0, 0, 1, 2, 3
#define WIDE_BEFORE_8 0, 0, 0, 0, 0, 0, 0, 0
#define WIDE_NEXT 1, 2, 3, 4, 5, 6, 7, 7
#define WIDE_THRICE_0 0, 0, 0, 1
#define WIDE_THRICE_1 1, 1, 2, 2
#define WIDE_THRICE_2 2, 3, 3, 3
#endif
enum { WIDE_HALF = WIDE_LANES / 2, WIDE_ALL = (1 << WIDE_LANES) - 1 }; // WIDE_ALL: a bit a lane

typedef float wide __attribute__((vector_size(4 * WIDE_LANES)));
typedef int32_t wide_int __attribute__((vector_size(4 * WIDE_LANES)));
typedef uint32_t wide_uint __attribute__((vector_size(4 * WIDE_LANES)));
typedef wide_int wide_mask;

struct wide3 {
    wide x, y, z;
};

static inline wide wide_of(float v) {
    return v - (wide){0}; // of -0 it makes -0, as a sum would not
}

static inline wide_int wide_int_of(int32_t v) {
    return v - (wide_int){0};
}

static inline wide wide_load(const float v[WIDE_LANES]) {
    wide w;
    memcpy(&w, v, sizeof w);
    return w;
}

// Bytes as numbers.
static inline wide wide_of_bytes(const uint8_t v[WIDE_LANES]) {
#if defined(__AVX512F__)
    return (wide)_mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128((const void *)v)));
#elif defined(__AVX2__)
    return (wide)_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64((const void *)v)));
#else
    wide w = {0};
    for (int i = 0; i < WIDE_LANES; i++)
        w[i] = v[i];
    return w;
#endif
}

static inline wide wide_of_signed_bytes(const int8_t v[WIDE_LANES]) {
#if defined(__AVX512F__)
    return (wide)_mm512_cvtepi32_ps(_mm512_cvtepi8_epi32(_mm_loadu_si128((const void *)v)));
#elif defined(__AVX2__)
    return (wide)_mm256_cvtepi32_ps(_mm256_cvtepi8_epi32(_mm_loadl_epi64((const void *)v)));
#else
    wide w = {0};
    for (int i = 0; i < WIDE_LANES; i++)
        w[i] = v[i];
    return w;
#endif
}

// The mask as it is. Where masks are joined that come straight from comparisons, clang joins one byte
// a lane and packs and unpacks for it: three times the instructions. What passes here it leaves alone.
static inline wide_mask wide_whole(wide_mask m) {
#if defined(__clang__) && defined(__AVX__) && !defined(__AVX512F__)
    __asm__("" : "+x"(m));
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
    return (uint32_t)_mm256_movemask_ps((__m256)m);
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
    const wide_int lane = {WIDE_LOWER, WIDE_UPPER};
    return (wide_int_of((int32_t)bits) & 1 << lane) != 0;
}

// Lanes of a where the mask is set, of b elsewhere.
static inline wide_int wide_int_select(wide_mask m, wide_int a, wide_int b) {
#if defined(__AVX__) && !defined(__AVX512F__)
    return (wide_int)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)m);
#else
    return (a & m) | (b & ~m);
#endif
}

static inline wide wide_select(wide_mask m, wide a, wide b) {
    return (wide)wide_int_select(m, (wide_int)a, (wide_int)b);
}

// As minf and maxf: a NaN in a gives b.
static inline wide wide_min(wide a, wide b) {
#if defined(__AVX512F__)
    return (wide)_mm512_min_ps((__m512)a, (__m512)b);
#elif defined(__AVX__)
    return (wide)_mm256_min_ps((__m256)a, (__m256)b);
#else
    return wide_select(a < b, a, b);
#endif
}

static inline wide wide_max(wide a, wide b) {
#if defined(__AVX512F__)
    return (wide)_mm512_max_ps((__m512)a, (__m512)b);
#elif defined(__AVX__)
    return (wide)_mm256_max_ps((__m256)a, (__m256)b);
#else
    return wide_select(a > b, a, b);
#endif
}

// In each lane what is so many lanes before it (1, 2, 4 or 8), or the first.
static inline wide wide_before(wide a, int lanes) {
    switch (lanes) {
    case 1: return __builtin_shufflevector(a, a, WIDE_BEFORE_1);
    case 2: return __builtin_shufflevector(a, a, WIDE_BEFORE_2);
    case 4: return __builtin_shufflevector(a, a, WIDE_BEFORE_4);
    default: return __builtin_shufflevector(a, a, WIDE_BEFORE_8);
    }
}

// What is in the lane behind, or the last.
static inline wide wide_next(wide a) {
    return __builtin_shufflevector(a, a, WIDE_NEXT);
}

static inline wide wide_abs(wide a) {
    return (wide)((wide_int)a & wide_int_of(0x7fffffff));
}

static inline wide wide_sqrt(wide a) {
#if defined(__AVX512F__)
    return (wide)_mm512_sqrt_ps((__m512)a);
#elif defined(__AVX__)
    return (wide)_mm256_sqrt_ps((__m256)a);
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
// Rows of two matrices of four by four side by side, to their columns and back.
static inline void wide_transpose(const __m256 in[4], __m256 out[4]) {
    const __m256d a = (__m256d)_mm256_unpacklo_ps(in[0], in[1]);
    const __m256d b = (__m256d)_mm256_unpackhi_ps(in[0], in[1]);
    const __m256d c = (__m256d)_mm256_unpacklo_ps(in[2], in[3]);
    const __m256d d = (__m256d)_mm256_unpackhi_ps(in[2], in[3]);
    out[0] = (__m256)_mm256_unpacklo_pd(a, c);
    out[1] = (__m256)_mm256_unpackhi_pd(a, c);
    out[2] = (__m256)_mm256_unpacklo_pd(b, d);
    out[3] = (__m256)_mm256_unpackhi_pd(b, d);
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
    __m256 r[4];
    for (int k = 0; k < 4; k++)
        r[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row[k])),
                                    _mm_loadu_ps(row[k + 4]), 1);
    wide_transpose(r, r);
    memcpy(out, r, sizeof r);
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
    __m256 r[4];
    memcpy(r, in, sizeof r);
    wide_transpose(r, r);
    for (int k = 0; k < 4; k++) {
        _mm_storeu_ps(row[k], _mm256_castps256_ps128(r[k]));
        _mm_storeu_ps(row[k + 4], _mm256_extractf128_ps(r[k], 1));
    }
#else
    for (int i = 0; i < WIDE_LANES; i++)
        for (int k = 0; k < 4; k++)
            row[i][k] = in[k][i];
#endif
}
