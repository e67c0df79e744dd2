// SPDX-License-Identifier: Apache-2.0
// Products of tiles, each of whose rows is stored in a way of its own, and weights: dot.cl and
// contract.cl over kernels/row_load.h. Tile `chunk` of entries and starts is the first of t.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"
#include "kernels/row_load.h"

#define ADD(number, name)                                                                          \
    case number:                                                                                   \
        name(p, weight, sum);                                                                      \
        break;

// sum += weight * row
ROW_INLINE void add_row(global const uchar *tile, uint entry, global const float *weight,
                        float16 *sum) {
    global const uchar *p = tile + ROW_OFFSET(entry);
    switch (ROW_WAY(entry)) {
        ROW_WAYS(ADD)
    }
}

kernel void dot_rows(global const uchar *t, global const uint *entry, global const ulong *start,
                     uint chunk, global const float *weight, uint coefficients,
                     global float16 *out, uint first) {
    const size_t tile = get_global_id(0);
    float16 sum[TILE_ROW];
    _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)
        sum[v] = 0;
    t += start[chunk + tile] - start[chunk];
    entry += (chunk + tile) * coefficients;
    for (uint c = 0; c < coefficients; c++, weight += TILE_CHANNELS)
        add_row(t, entry[c], weight, sum);
    out += (first + tile) * TILE_ROW;
    _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)
        out[v] = sum[v];
}

kernel void add_terms_rows(global const uchar *t, global const uint *entry,
                           global const ulong *start, uint chunk, global const float *weight,
                           global const uint *term, uint terms, uint coefficients,
                           global float16 *out, uint first) {
    const size_t tile = get_global_id(0);
    float16 sum[TILE_ROW];
    out += (first + tile) * TILE_ROW;
    _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)
        sum[v] = out[v];
    t += start[chunk + tile] - start[chunk];
    entry += (chunk + tile) * coefficients;
    for (uint k = 0; k < terms; k++, weight += TILE_CHANNELS)
        add_row(t, entry[term[k]], weight, sum);
    _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)
        out[v] = sum[v];
}

kernel void contract_rows(global const uchar *t, global const uint *entry,
                          global const ulong *start, uint chunk, global const float *weight,
                          global const uint *index, global const uint *begin, uint coefficients,
                          uint reduced, uint first, global float16 *out) {
    const size_t tile = get_global_id(0) / reduced;
    const uint r = get_global_id(0) % reduced;
    float16 sum[TILE_ROW];
    _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)
        sum[v] = 0;
    t += start[chunk + first + tile] - start[chunk];
    entry += (chunk + first + tile) * coefficients;
    for (uint i = begin[r]; i < begin[r + 1]; i++)
        add_row(t, entry[index[i]], weight + (size_t)i * TILE_CHANNELS, sum);
    out += get_global_id(0) * TILE_ROW;
    _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)
        out[v] = sum[v];
}
