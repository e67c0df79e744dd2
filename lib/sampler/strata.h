// SPDX-License-Identifier: Apache-2.0
// What the stratified samplers share: seeds of a dimension, and the 1-D draw.
#pragma once

#include "sampler/permute.h"
#include "sampler/sampler.h"

struct strata_seeds {
    uint32_t order, a, b;
    uint64_t jitter;
};

// Jitter is a number of each point, the permutations are the same for all points of a dimension.
static inline struct strata_seeds strata_next(struct sampler *s) {
    const uint64_t d = hash_u64((uint64_t)s->seed << 32 | s->dimension++);
    const uint64_t e = d * 0xd1342543de82ef95u; // its top bits depend on all of d
    return (struct strata_seeds){(uint32_t)d, (uint32_t)(d >> 32), (uint32_t)(e >> 32),
                                 hash_u64(d + (uint64_t)s->index * 0x9e3779b97f4a7c15u)};
}

static inline float strata_inside(uint32_t stratum, float jitter, uint32_t count) {
    return minf(((float)stratum + jitter) / (float)count, 0x1.fffffep-1f);
}

// Integer part of the square root: columns of the grid.
static inline uint32_t strata_columns(uint32_t count) {
    return (uint32_t)sqrtf((float)count);
}

static inline float strata_next_1d(struct sampler *s) {
    const struct strata_seeds k = strata_next(s);
    return strata_inside(permute(s->index % s->count, s->count, k.order),
                         uniform_float((uint32_t)(k.jitter >> 32)), s->count);
}
