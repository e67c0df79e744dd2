// SPDX-License-Identifier: Apache-2.0
// MurmurHash3_x86_32 (A. Appleby 2011, public domain), which Cryptomatte names objects by.
#pragma once

#include <stddef.h>
#include <stdint.h>

static inline uint32_t murmur_rotate(uint32_t x, int bits) {
    return x << bits | x >> (32 - bits);
}

static inline uint32_t murmur_scramble(uint32_t k) {
    return murmur_rotate(k * 0xcc9e2d51u, 15) * 0x1b873593u;
}

// Of `size` bytes, with seed 0.
static inline uint32_t murmur3_32(const char *data, size_t size) {
    const unsigned char *p = (const unsigned char *)data;
    uint32_t h = 0, tail = 0;
    size_t i = 0;
    for (; i + 4 <= size; i += 4) {
        const uint32_t k = (uint32_t)p[i] | (uint32_t)p[i + 1] << 8 | (uint32_t)p[i + 2] << 16 |
                           (uint32_t)p[i + 3] << 24;
        h = murmur_rotate(h ^ murmur_scramble(k), 13) * 5 + 0xe6546b64u;
    }
    for (size_t k = size - i; k-- > 0;)
        tail = tail << 8 | p[i + k];
    h ^= murmur_scramble(tail);
    h ^= (uint32_t)size;
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return h ^ h >> 16;
}
