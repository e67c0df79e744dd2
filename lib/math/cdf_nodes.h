// SPDX-License-Identifier: Apache-2.0
// Running sums of many distributions of one length, and which entry a number falls on.
//
// A search by halves waits for memory at nearly every step. Here one cache line holds sixteen sums,
// another the first of each of sixteen such lines, and so on: a search reads a line a level, and
// many searches go through the levels side by side, so that they wait together.
#pragma once

#include <stddef.h>

#include "math/wide.h"

enum { CDF_LEVELS = 8, CDF_NODE = 16 };

struct cdf_nodes {
    int levels;
    size_t width[CDF_LEVELS];  // numbers of one distribution in each level
    float *level[CDF_LEVELS];  // [0]: the sums; what is beyond their end is 1; owned
};

// For `rows` distributions of `count` entries.
void cdf_nodes_init(struct cdf_nodes *n, size_t rows, int count);
void cdf_nodes_finish(struct cdf_nodes *n);

// The count + 1 sums of a distribution, from 0 to 1. Who has written them calls cdf_nodes_index.
static inline float *cdf_nodes_row(const struct cdf_nodes *n, size_t row) {
    return n->level[0] + row * n->width[0];
}

void cdf_nodes_index(struct cdf_nodes *n, size_t row);

static inline const float *cdf_node(const struct cdf_nodes *n, int level, size_t row, uint32_t i) {
    return n->level[level] + row * n->width[level] + (size_t)CDF_NODE * i;
}

// The last of a node's numbers that is not above u; the first one never is.
static inline uint32_t cdf_child(const float *node, uint32_t i, float u) {
    uint32_t passed = 0;
    for (int k = 0; k < CDF_NODE; k += WIDE_LANES)
        passed |= wide_bits(wide_load(node + k) <= wide_of(u)) << k;
    return CDF_NODE * i + (uint32_t)__builtin_popcount(passed) - 1;
}

// The last i with sum i <= u, u in [0, 1).
static inline uint32_t cdf_nodes_find(const struct cdf_nodes *n, size_t row, float u) {
    uint32_t i = 0;
    for (int level = n->levels; level-- > 0;)
        i = cdf_child(cdf_node(n, level, row, i), i, u);
    return i;
}

// For `count` numbers, each in a row of its own.
static inline void cdf_nodes_find_all(const struct cdf_nodes *n, int count, const uint32_t *row,
                                      const float *u, uint32_t *found) {
    for (int i = 0; i < count; i++)
        found[i] = 0;
    for (int level = n->levels; level-- > 0;)
        for (int i = 0; i < count; i++) {
            found[i] = cdf_child(cdf_node(n, level, row[i], found[i]), found[i], u[i]);
            if (level > 0)
                __builtin_prefetch(cdf_node(n, level - 1, row[i], found[i]));
        }
}
