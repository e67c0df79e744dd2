// SPDX-License-Identifier: Apache-2.0
// From many coefficients to few, before a frame is asked for: what stays as it is while one curve of
// one object is edited (other curves, other objects) goes into the coefficients.
//
//     out[tile][target[i]][channel][lane] += weight[i][channel] T[tile][index[i]][channel][lane],
//                                            start[run] <= i < start[run + 1], in order
//
// One work-item a tile and a run, which makes TILE_REDUCED neighbouring coefficients: few enough for their
// sums to stay in a cache, while the rows of T come in the order in which they lie in memory.
// Tiles of t begin with number `first`, those of out with 0.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"
#include "kernels/tile_add.h"

#define DEFINE(suffix, type)                                                                       \
    kernel void contract_##suffix(global const type *restrict t, global const uint *target,        \
                                  global const float *weight, global const uint *index,            \
                                  global const uint *start, uint coefficients, uint reduced,       \
                                  uint first, global float16 *restrict out) {                      \
        const uint runs = (reduced + TILE_REDUCED - 1) / TILE_REDUCED;                             \
        const size_t tile = get_global_id(0) / runs;                                               \
        const uint run = get_global_id(0) % runs;                                                  \
        const uint from = run * TILE_REDUCED, end = min(from + TILE_REDUCED, reduced);             \
        t += (first + tile) * coefficients * TILE_ROW;                                             \
        out += tile * reduced * TILE_ROW;                                                          \
        for (uint k = from * TILE_ROW; k < end * TILE_ROW; k++)                                    \
            out[k] = 0;                                                                            \
        for (uint i = start[run]; i < start[run + 1]; i++)                                         \
            add_row_to_##suffix(t + (size_t)index[i] * TILE_ROW, 0,                                \
                                weight + (size_t)i * TILE_CHANNELS,                                \
                                out + (size_t)target[i] * TILE_ROW);                               \
    }

DEFINE(f32, float16)
DEFINE(bf16, ushort16)
