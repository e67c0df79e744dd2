// SPDX-License-Identifier: Apache-2.0
// Products of tiles, each of whose rows is stored in a way of its own, and weights: dot.cl and
// contract.cl over kernels/row_load.h. Tile `chunk` of entries and starts is the first of t.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"
#include "kernels/row_load.h"

kernel void dot_rows(global const uchar *t, global const uint *entry, global const ulong *start,
                     uint chunk, global const float *weight, uint coefficients,
                     global float16 *out, uint first) {
    const size_t tile = get_global_id(0);
    row_add(t + (start[chunk + tile] - start[chunk]), entry + (chunk + tile) * coefficients, 0,
            weight, coefficients, true, out + (first + tile) * TILE_ROW);
}

kernel void add_terms_rows(global const uchar *t, global const uint *entry,
                           global const ulong *start, uint chunk, global const float *weight,
                           global const uint *term, uint terms, uint coefficients,
                           global float16 *out, uint first) {
    const size_t tile = get_global_id(0);
    row_add(t + (start[chunk + tile] - start[chunk]), entry + (chunk + tile) * coefficients, term,
            weight, terms, false, out + (first + tile) * TILE_ROW);
}

kernel void contract_rows(global const uchar *t, global const uint *entry,
                          global const ulong *start, uint chunk, global const float *weight,
                          global const uint *index, global const uint *begin, uint coefficients,
                          uint reduced, uint first, global float16 *out) {
    const size_t tile = chunk + first + get_global_id(0) / reduced;
    const uint r = get_global_id(0) % reduced;
    row_add(t + (start[tile] - start[chunk]), entry + tile * coefficients, index + begin[r],
            weight + (size_t)begin[r] * TILE_CHANNELS, begin[r + 1] - begin[r], true,
            out + get_global_id(0) * TILE_ROW);
}
