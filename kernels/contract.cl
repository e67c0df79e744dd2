// SPDX-License-Identifier: Apache-2.0
// From many coefficients to few, before a frame is asked for: what stays as it is while one curve of
// one object is edited (other curves, other objects) goes into the coefficients.
//
//     out[tile][r][channel][lane] = sum_i weight[i][channel] T[tile][index[i]][channel][lane],
//                                   start[r] <= i < start[r + 1], in order
//
// One work-item a tile and TILE_REDUCED neighbouring r, whose rows of T are neighbours too where the
// first axis of a matrix is contracted. The next row of a list, for a processor far away then, is sent
// for while one is added. Tiles of t begin with number `first`, those of out with 0.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"
#include "kernels/tile_add.h"

#define DEFINE(suffix, type)                                                                       \
    kernel void contract_##suffix(global const type *t, global const float *weight,                \
                                  global const uint *index, global const uint *start,              \
                                  uint coefficients, uint reduced, uint first,                     \
                                  global float16 *out) {                                           \
        float16 sum[TILE_REDUCED][TILE_ROW];                                                       \
        const uint parts = (reduced + TILE_REDUCED - 1) / TILE_REDUCED;                            \
        const size_t tile = get_global_id(0) / parts;                                              \
        const uint from = get_global_id(0) % parts * TILE_REDUCED;                                 \
        const uint count = min((uint)TILE_REDUCED, reduced - from);                                \
        const size_t last = start[reduced] - 1;                                                    \
        uint longest = 0;                                                                          \
        for (uint r = 0; r < count; r++) {                                                         \
            longest = max(longest, start[from + r + 1] - start[from + r]);                         \
            for (uint v = 0; v < TILE_ROW; v++)                                                    \
                sum[r][v] = 0;                                                                     \
        }                                                                                          \
        t += (first + tile) * coefficients * TILE_ROW;                                             \
        for (uint k = 0; k < longest; k++)                                                         \
            for (uint r = 0; r < count; r++) {                                                     \
                const size_t i = (size_t)start[from + r] + k;                                      \
                if (i >= start[from + r + 1])                                                      \
                    continue;                                                                      \
                const size_t later = index[min(i + 1, last)];                                      \
                add_row_##suffix(t + (size_t)index[i] * TILE_ROW, t + later * TILE_ROW,            \
                                 weight + i * TILE_CHANNELS, sum[r]);                              \
            }                                                                                      \
        out += (tile * reduced + from) * TILE_ROW;                                                 \
        for (uint r = 0; r < count; r++)                                                           \
            for (uint v = 0; v < TILE_ROW; v++)                                                    \
                out[r * TILE_ROW + v] = sum[r][v];                                                 \
    }

DEFINE(f32, float16)
DEFINE(bf16, ushort16)
