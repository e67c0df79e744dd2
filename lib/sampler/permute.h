// SPDX-License-Identifier: Apache-2.0
// Random access to a random permutation: no memory, any length (Kensler 2013, Correlated
// Multi-Jittered Sampling, section "Pseudorandom permutations").
#pragma once

#include <stdint.h>

#include "math/hash.h"

// A bijection of [0, mask], mask + 1 a power of two: every step can be undone modulo mask + 1.
static inline uint32_t permute_mix(uint32_t i, uint32_t mask, uint32_t seed) {
    const uint32_t s1 = seed, s2 = (uint32_t)(seed * 0x9e3779b97f4a7c15u >> 32);
    const uint32_t s3 = (uint32_t)(seed * 0xd1342543de82ef95u >> 32);
    const int half = (33 - __builtin_clz(mask)) / 2; // at least 1
    for (int round = 0; round < 2; round++) {
        i = (i ^ s1) * (s2 | 1) & mask;
        i ^= i >> half;
        i = (i + s3) * 0x8b7f2ba5u & mask;
        i ^= i >> half;
        i = (i + (s2 >> 16)) * ((s1 >> 8) | 1) & mask;
        i ^= i >> half;
    }
    return i;
}

// Where the permutation of [0, count) with this seed puts i < count. The rotation at the end makes
// every place of i exactly equally likely, which is what keeps means unbiased.
static inline uint32_t permute(uint32_t i, uint32_t count, uint32_t seed) {
    if (count < 2)
        return 0;
    const uint32_t rotation = (uint32_t)((uint64_t)hash_u32(~seed) * count >> 32);
    const uint32_t mask = UINT32_MAX >> __builtin_clz(count - 1);
    do { // walk along the cycle until it is back inside; at most half of the steps lie outside
        i = permute_mix(i, mask, seed);
    } while (i >= count);
    i += rotation;
    return i < count ? i : i - count;
}
