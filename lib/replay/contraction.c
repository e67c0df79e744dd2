// SPDX-License-Identifier: Apache-2.0
#include "replay/contraction.h"

#include "kernels/tile.h"

struct contraction contraction_of(enum tensor_storage storage, uint32_t coefficients,
                                  uint32_t reduced, const uint32_t *target, const double *weight,
                                  struct arena *arena) {
    // Rows of all kinds are sorted by their ways first: that takes a list for each number.
    struct contraction c = {.reduced = reduced,
                            .together = storage == TENSOR_ROWS ? 1 : TILE_REDUCED};
    const uint32_t runs = contraction_runs(&c);
    uint32_t *start = arena_alloc(arena, ((size_t)runs + 1) * sizeof *start);
    uint32_t *index = arena_alloc(arena, (size_t)coefficients * sizeof *index);
    uint32_t *to = arena_alloc(arena, (size_t)coefficients * sizeof *to);
    float *w = arena_alloc(arena, (size_t)coefficients * TILE_CHANNELS * sizeof *w);
    uint32_t *next = mem_array(runs, sizeof *next);
    for (uint32_t i = 0; i < coefficients; i++)
        start[target[i] / c.together + 1]++;
    for (uint32_t r = 0; r < runs; r++) {
        start[r + 1] += start[r];
        next[r] = start[r];
    }
    for (uint32_t i = 0; i < coefficients; i++) {
        const uint32_t at = next[target[i] / c.together]++;
        index[at] = i;
        to[at] = target[i];
        for (size_t k = 0; k < TILE_CHANNELS; k++)
            w[TILE_CHANNELS * (size_t)at + k] = (float)weight[TILE_CHANNELS * (size_t)i + k];
    }
    mem_free(next);
    c.start = start;
    c.index = index;
    c.target = to;
    c.weight = w;
    return c;
}
