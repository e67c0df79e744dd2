// SPDX-License-Identifier: Apache-2.0
// A linear map of coefficients to fewer ones: which goes into which, with what weight.
//
//     out[target[i]] += weight[i] T[index[i]], in the order of i; out begins with 0
//
// What makes `together` neighbouring numbers is one run of i: its coefficients ascend, so that they are
// read as they lie in memory, while the sums stay in a cache. A list for each number instead reads rows
// that lie far apart.
#pragma once

#include "base/mem.h"
#include "transport/tensor.h"

struct contraction {
    uint32_t reduced, together; // numbers that are made; and by a run
    const uint32_t *start;      // [runs + 1]: run r has start[r] <= i < start[r + 1]
    const uint32_t *index, *target;
    const float *weight; // [i][channel]
};

static inline uint32_t contraction_runs(const struct contraction *c) {
    return (c->reduced + c->together - 1) / c->together;
}

// The map by which each coefficient goes into one number, as suits a storage: target[coefficient],
// weight[coefficient][channel]. Memory from the arena.
struct contraction contraction_of(enum tensor_storage storage, uint32_t coefficients,
                                  uint32_t reduced, const uint32_t *target, const double *weight,
                                  struct arena *arena);
