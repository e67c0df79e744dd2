// SPDX-License-Identifier: Apache-2.0
// Integer mixing and the numbers made from it. Every random number of relume is a function of
// (pixel or texel, sample index, dimension, seed), never of the thread.
#pragma once

#include <stdint.h>

// Full-avalanche mixer of 32 bits (Chris Wellons, lowbias32).
static inline uint32_t hash_u32(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

static inline uint32_t hash_combine(uint32_t seed, uint32_t v) {
    return hash_u32(seed ^ (v + 0x9e3779b9u + (seed << 6) + (seed >> 2)));
}

// 64-bit finaliser of SplitMix64 (Steele, Lea, Flood 2014).
static inline uint64_t hash_u64(uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

// Uniform in [0, 1), never 1: the upper 24 bits.
static inline float uniform_float(uint32_t bits) {
    return (float)(bits >> 8) * 0x1p-24f;
}

// A small sequential generator for tests and tools: SplitMix64.
struct rng {
    uint64_t state;
};

static inline uint32_t rng_u32(struct rng *r) {
    const uint64_t h = hash_u64(r->state);
    r->state += 0x9e3779b97f4a7c15u;
    return (uint32_t)(h >> 32);
}

static inline float rng_float(struct rng *r) {
    return uniform_float(rng_u32(r));
}
