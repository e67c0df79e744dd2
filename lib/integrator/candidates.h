// SPDX-License-Identifier: Apache-2.0
// Which of several light samples of a vertex is traced: resampled importance sampling (Talbot, Cline
// and Egbert 2005). One is kept, with a chance in proportion to the luminance it would bring were
// nothing in the way, and stands for the mean of all. Of a broad light, a single sample often misses the
// lobe of a glossy vertex, and one that hits it is bright.
//
// The candidates are one sample, shifted (Cranley and Patterson 1976): each by itself is distributed
// as light samples are, which is all that the mean asks for.
#pragma once

#include "math/wide.h"

// Measured in a room with metal chairs (bench/light_candidates.py): 3 of a sky leave 0.77 to 0.80 of
// relMSE for 1.0 to 1.1 times the time, 8 leave 0.72 to 0.74 for 1.2. Towards small lights they cost what
// they gain.
enum { MOST_CANDIDATES = 8, CANDIDATES_OF_A_SKY = 3 };

// What is added to the random numbers of the first candidate, modulo 1.
struct candidate_shift {
    float choice; // of the light
    float x, y;   // of the point on it
};

// A step of uniform_float's grid, so that sums stay on it and no number is met more often than others.
static inline float candidate_step(double x) {
    return (float)(floor((x - floor(x)) * 0x1p24) * 0x1p-24);
}

// The points by the plane's R sequence (Roberts 2018): powers of 1 / 1.32471795724, the plastic number.
static inline struct candidate_shift candidate_shift(uint32_t k, uint32_t count) {
    return (struct candidate_shift){candidate_step((double)k / count),
                                    candidate_step(0.7548776662466927 * k),
                                    candidate_step(0.5698402909980532 * k)};
}

static inline float candidate_number(float u, float shift) {
    return u < 1 - shift ? u + shift : u - (1 - shift);
}

static inline wide candidate_numbers(wide u, float shift) {
    return wide_select(u < 1 - shift, u + shift, u - (1 - shift));
}

// The values so far and a random number, which each decision leaves uniform again.
struct candidates_seen {
    float sum, u;
};

struct candidates_seen_wide {
    wide sum, u;
};

static const float CANDIDATE_LAST = 0x1.fffffep-1f; // below 1

// Whether the next candidate, of value >= 0, takes the place of what was kept. One that is infinite does,
// for the film to reject and count.
static inline bool candidate_takes(struct candidates_seen *c, float value) {
    if (!(value > 0))
        return false;
    c->sum += value;
    const float q = value / c->sum;
    const bool takes = c->u < q || value == INFINITY;
    c->u = minf(takes ? c->u / q : (c->u - q) / (1 - q), CANDIDATE_LAST);
    return takes;
}

static inline wide_mask candidates_take(struct candidates_seen_wide *c, wide value) {
    const wide_mask counts = wide_whole(value > 0);
    c->sum = wide_select(counts, c->sum + value, c->sum);
    const wide q = value / c->sum;
    const wide_mask takes = wide_both(counts, wide_either(c->u < q, value == INFINITY));
    const wide u = wide_select(takes, c->u / q, (c->u - q) / (1 - q));
    c->u = wide_select(counts, wide_min(u, wide_of(CANDIDATE_LAST)), c->u);
    return takes;
}
