// SPDX-License-Identifier: Apache-2.0
// Discrete and piecewise-constant distributions.
//
// Built in double from non-negative weights. Sums of zero make the uniform distribution.
#pragma once

#include <stddef.h>
#include <stdint.h>

// The interval of `count` ascending sums from 0 to 1 that holds u in [0,1), and where in it u
// stands, in [0,1).
uint32_t cdf_find(const float *cdf, uint32_t count, float u, float *remapped);

struct distribution {
    uint32_t count;
    float *cdf;   // count + 1 values from 0 to 1, owned
    double total; // sum of the weights
};

void distribution_init(struct distribution *d, const float *weights, uint32_t count);
void distribution_finish(struct distribution *d);

// The entry whose interval holds u in [0,1); *pmf is its probability (> 0), *remapped (may be
// NULL) where u stands inside the interval, in [0,1).
uint32_t distribution_sample(const struct distribution *d, float u, float *pmf, float *remapped);

static inline float distribution_pmf(const struct distribution *d, uint32_t i) {
    return d->cdf[i + 1] - d->cdf[i];
}

// Walker's alias table: a sample in constant time, for selections made at every vertex.
struct alias_table {
    uint32_t count;
    struct alias_entry {
        float threshold; // keep the entry when the remapped number is below this
        uint32_t other;
        float pmf;
    } *entries; // owned
};

void alias_init(struct alias_table *a, const float *weights, uint32_t count);
void alias_finish(struct alias_table *a);
uint32_t alias_sample(const struct alias_table *a, float u, float *pmf, float *remapped);
// For tables whose entries are too many for the 24 bits of a float.
uint32_t alias_sample_fine(const struct alias_table *a, double u, float *pmf);
