// SPDX-License-Identifier: Apache-2.0
// Random access to a random permutation: no memory, any length (Kensler 2013, Correlated
// Multi-Jittered Sampling, section "Pseudorandom permutations").
#pragma once

#include <stdint.h>

#include "math/hash.h"

// A bijection of [0, mask], mask + 1 a power of two: every step can be undone modulo mask + 1.
static inline uint32_t permute_mix(uint32_t i, uint32_t mask, uint32_t seed) {
    const uint32_t s1 = seed, s2 = hash_u32(seed), s3 = hash_u32(seed ^ 0x68e31da4u);
    const int half = (32 - __builtin_clz(mask | 1)) / 2;
    for (int round = 0; round < 2; round++) {
        i ^= s1 & mask;
        i *= s2 | 1;
        i &= mask;
        i ^= i >> (half ? half : 1);
        i += s3;
        i *= 0x8b7f2ba5u;
        i &= mask;
        i ^= i >> (half ? half : 1);
        i += s2 >> 16;
        i *= (s1 >> 8) | 1;
        i &= mask;
        i ^= i >> (half > 1 ? half - 1 : 1);
    }
    return (i + (s3 >> 3)) & mask;
}

// Where the permutation of [0, count) with this seed puts i < count.
static inline uint32_t permute(uint32_t i, uint32_t count, uint32_t seed) {
    if (count < 2)
        return 0;
    const uint32_t mask = UINT32_MAX >> __builtin_clz(count - 1);
    do { // walk along the cycle until it is back inside; at most half of the steps lie outside
        i = permute_mix(i, mask, seed);
    } while (i >= count);
    return i;
}
