// SPDX-License-Identifier: Apache-2.0
// Sobol's first two dimensions and Owen's scrambling of them, on words with their bits mirrored.
//
// A nested uniform (Owen) scramble flips each bit by a function of the bits above it. On reversed
// bits this is a mixer in which information only moves upwards: multiplications by even numbers,
// xor and addition (Laine and Karras 2011; constants by Vegdahl 2021, Building a Better LK Hash).
//
// The first dimension of point `index` is, reversed, the index itself. The second's direction numbers
// are, reversed, the powers of (1 + x) over GF(2), so bit i of index becomes (1 + x)^i: the polynomial
// index(x) is shifted to index(1 + x), by halves of 16, 8, 4, 2 and 1 since (1 + x)^16 = 1 + x^16.
#pragma once

#include <stdint.h>

#include "math/wide_hash.h"

// For one word, and for those of all lanes.
#define OWEN_FUNCTIONS(word, scramble_reversed, second_reversed)                                   \
    static inline word scramble_reversed(word x, word seed) {                                      \
        x ^= x * 0x3d20adeau;                                                                      \
        x += seed;                                                                                 \
        x *= (seed >> 16) | 1;                                                                     \
        x ^= x * 0x05526c56u;                                                                      \
        x ^= x * 0x53a22864u;                                                                      \
        return x;                                                                                  \
    }                                                                                              \
                                                                                                   \
    static inline word second_reversed(word index) {                                               \
        index ^= index >> 16;                                                                      \
        index ^= (index & 0xff00ff00u) >> 8;                                                       \
        index ^= (index & 0xf0f0f0f0u) >> 4;                                                       \
        index ^= (index & 0xccccccccu) >> 2;                                                       \
        return index ^ (index & 0xaaaaaaaau) >> 1;                                                 \
    }

OWEN_FUNCTIONS(uint32_t, owen_scramble_reversed, sobol_second_reversed)
OWEN_FUNCTIONS(wide_uint, owen_scramble_reversed_wide, sobol_second_reversed_wide)
