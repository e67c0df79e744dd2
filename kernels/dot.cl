// SPDX-License-Identifier: Apache-2.0
// Products of tiles and weights: what a picture is, once a tensor is there.
//
//     dot:       out[tile][channel][lane]  = sum_c weight[c][channel] T[tile][c][channel][lane]
//     add_terms: out[tile][channel][lane] += sum_k weight[k][channel] T[tile][term[k]][channel][lane]
//
// One work-item a tile; the tiles of t begin with number `first` of out.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"

#define LOAD_F32(p, i) (p)[i]
#define LOAD_BF16(p, i) as_float16(convert_uint16((p)[i]) << 16)

#define DEFINE(suffix, type, LOAD)                                                                 \
    kernel void dot_##suffix(global const type *t, global const float *weight, uint coefficients,  \
                             global float16 *out, uint first) {                                    \
        float16 r0 = 0, r1 = 0, r2 = 0, r3 = 0, g0 = 0, g1 = 0, g2 = 0, g3 = 0;                    \
        float16 b0 = 0, b1 = 0, b2 = 0, b3 = 0;                                                    \
        const size_t tile = get_global_id(0);                                                      \
        t += tile * coefficients * TILE_ROW;                                                       \
        for (uint c = 0; c < coefficients; c++, t += TILE_ROW, weight += TILE_CHANNELS) {          \
            r0 += weight[0] * LOAD(t, 0);                                                          \
            r1 += weight[0] * LOAD(t, 1);                                                          \
            r2 += weight[0] * LOAD(t, 2);                                                          \
            r3 += weight[0] * LOAD(t, 3);                                                          \
            g0 += weight[1] * LOAD(t, 4);                                                          \
            g1 += weight[1] * LOAD(t, 5);                                                          \
            g2 += weight[1] * LOAD(t, 6);                                                          \
            g3 += weight[1] * LOAD(t, 7);                                                          \
            b0 += weight[2] * LOAD(t, 8);                                                          \
            b1 += weight[2] * LOAD(t, 9);                                                          \
            b2 += weight[2] * LOAD(t, 10);                                                         \
            b3 += weight[2] * LOAD(t, 11);                                                         \
        }                                                                                          \
        out += (first + tile) * TILE_ROW;                                                          \
        out[0] = r0, out[1] = r1, out[2] = r2, out[3] = r3;                                        \
        out[4] = g0, out[5] = g1, out[6] = g2, out[7] = g3;                                        \
        out[8] = b0, out[9] = b1, out[10] = b2, out[11] = b3;                                      \
    }                                                                                              \
                                                                                                   \
    kernel void add_terms_##suffix(global const type *t, global const float *weight,               \
                                   global const uint *term, uint terms, uint coefficients,         \
                                   global float16 *out, uint first) {                              \
        const size_t tile = get_global_id(0);                                                      \
        t += tile * coefficients * TILE_ROW;                                                       \
        out += (first + tile) * TILE_ROW;                                                          \
        for (uint k = 0; k < terms; k++, weight += TILE_CHANNELS) {                                \
            global const type *row = t + (size_t)term[k] * TILE_ROW;                               \
            for (uint channel = 0; channel < TILE_CHANNELS; channel++)                             \
                for (uint v = 0; v < TILE_VECTORS; v++)                                            \
                    out[channel * TILE_VECTORS + v] +=                                             \
                        weight[channel] * LOAD(row, channel * TILE_VECTORS + v);                   \
        }                                                                                          \
    }

DEFINE(f32, float16, LOAD_F32)
DEFINE(bf16, ushort16, LOAD_BF16)
