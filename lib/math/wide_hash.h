// SPDX-License-Identifier: Apache-2.0
// hash.h for all lanes.
#pragma once

#include "math/wide.h"

typedef uint32_t wide_half __attribute__((vector_size(4 * WIDE_HALF)));
typedef uint64_t wide_half64 __attribute__((vector_size(8 * WIDE_HALF)));

static inline wide_uint wide_hash_u32(wide_uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

static inline wide_uint wide_hash_combine(wide_uint seed, wide_uint v) {
    return wide_hash_u32(seed ^ (v + 0x9e3779b9u + (seed << 6) + (seed >> 2)));
}

// 64-bit words: of the lower half of the lanes, and of the upper.
struct wide_u64 {
    wide_half64 a, b;
};

static inline wide_half wide_lower(wide_uint v) {
    return __builtin_shufflevector(v, v, WIDE_LOWER);
}

static inline wide_half wide_upper(wide_uint v) {
    return __builtin_shufflevector(v, v, WIDE_UPPER);
}

static inline struct wide_u64 wide_widen(wide_uint v) {
    return (struct wide_u64){__builtin_convertvector(wide_lower(v), wide_half64),
                             __builtin_convertvector(wide_upper(v), wide_half64)};
}

static inline wide_uint wide_low_word(struct wide_u64 v) {
    const wide_half a = __builtin_convertvector(v.a, wide_half);
    const wide_half b = __builtin_convertvector(v.b, wide_half);
    return __builtin_shufflevector(a, b, WIDE_LOWER, WIDE_UPPER);
}

static inline wide_uint wide_high_word(struct wide_u64 v) {
    return wide_low_word((struct wide_u64){v.a >> 32, v.b >> 32});
}

static inline wide_half64 wide_half_hash(wide_half64 x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

static inline struct wide_u64 wide_hash_u64(struct wide_u64 x) {
    return (struct wide_u64){wide_half_hash(x.a), wide_half_hash(x.b)};
}

// hi << 32 | lo
static inline struct wide_u64 wide_join(wide_uint hi, wide_uint lo) {
    const struct wide_u64 h = wide_widen(hi), l = wide_widen(lo);
    return (struct wide_u64){h.a << 32 | l.a, h.b << 32 | l.b};
}

static inline wide wide_uniform_float(wide_uint bits) {
    return __builtin_convertvector((wide_int)(bits >> 8), wide) * 0x1p-24f;
}
