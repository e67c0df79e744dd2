// SPDX-License-Identifier: Apache-2.0
// Products of tiles and weights: what a picture is, once a tensor is there.
//
//     dot:       out[tile][channel][lane]  = sum_c weight[c][channel] T[tile][c][channel][lane]
//     add_terms: out[tile][channel][lane] += sum_k weight[k][channel] T[tile][term[k]][channel][lane]
//
// One work-item a tile; the tiles of t begin with number `first` of out. Sums stay in registers or on
// the stack: in `out`, which may overlap t for all that a compiler knows, each row would wait for the
// one before it to be written. Behind the last rows of a tile the next tile's are sent for.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"
#include "kernels/tile_add.h"

#define DEFINE(suffix, type, LATER)                                                                \
    kernel void dot_##suffix(global const type *t, global const float *weight, uint coefficients,  \
                             global float16 *out, uint first) {                                    \
        const size_t tile = get_global_id(0);                                                      \
        float16 sum[TILE_ROW];                                                                     \
        _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)                                      \
            sum[v] = 0;                                                                            \
        t += tile * coefficients * TILE_ROW;                                                       \
        for (uint c = 0; c < coefficients; c++, t += TILE_ROW, weight += TILE_CHANNELS)            \
            add_row_##suffix(t, LATER, weight, sum);                                               \
        out += (first + tile) * TILE_ROW;                                                          \
        _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)                                      \
            out[v] = sum[v];                                                                       \
    }                                                                                              \
                                                                                                   \
    kernel void add_terms_##suffix(global const type *t, global const float *weight,               \
                                   global const uint *term, uint terms, uint coefficients,         \
                                   global float16 *out, uint first) {                              \
        const size_t tile = get_global_id(0);                                                      \
        float16 sum[TILE_ROW];                                                                     \
        t += tile * coefficients * TILE_ROW;                                                       \
        out += (first + tile) * TILE_ROW;                                                          \
        _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)                                      \
            sum[v] = out[v];                                                                       \
        for (uint k = 0; k < terms; k++) {                                                         \
            const uint ahead = (k + TILE_AHEAD) % terms;                                           \
            const size_t later = term[ahead] + (ahead < k ? (size_t)coefficients : 0);             \
            add_row_##suffix(t + (size_t)term[k] * TILE_ROW, t + later * TILE_ROW,                 \
                             weight + k * TILE_CHANNELS, sum);                                     \
        }                                                                                          \
        _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)                                      \
            out[v] = sum[v];                                                                       \
    }

DEFINE(f32, float16, 0)
DEFINE(bf16, ushort16, t + TILE_AHEAD * TILE_ROW)
