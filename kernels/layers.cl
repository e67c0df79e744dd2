// SPDX-License-Identifier: Apache-2.0
// Sums that are kept in layers, a band of wavelets each, so that one can be begun anew alone.
//
//     clear_layer: out[tile] = 0 for the tiles from `first` on
//     add_layers:  out[tile][channel][lane] = sum_l layer[l][tile][channel][lane]
//
// One work-item a tile.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"

kernel void clear_layer(global float16 *out, uint first) {
    out += (first + get_global_id(0)) * TILE_ROW;
    for (uint i = 0; i < TILE_ROW; i++)
        out[i] = 0;
}

kernel void add_layers(global const float16 *layer, uint layers, uint tiles, global float16 *out) {
    const size_t tile = get_global_id(0);
    for (uint i = 0; i < TILE_ROW; i++) {
        float16 sum = 0;
        for (uint l = 0; l < layers; l++)
            sum += layer[((size_t)l * tiles + tile) * TILE_ROW + i];
        out[tile * TILE_ROW + i] = sum;
    }
}
