// SPDX-License-Identifier: Apache-2.0
// Periodic Daubechies-4 transform of the coefficients of each lane (Daubechies 1988), in place.
//
// Coefficients are a power of two, at least 4. After it coefficient 0 .. n/2 - 1 are the smooth half
// of the level before, the rest its details: the order of curve/wavelet.h. `steps` levels are done.
// One work-item a tile and row of 16 lanes; scratch holds as many floats as the tiles do.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"

#define D1 0.4829629131445341f
#define D2 0.8365163037378077f
#define D3 0.2241438680420134f
#define D4 -0.1294095225512603f

kernel void daubechies4(global float16 *t, global float16 *scratch, uint coefficients, uint steps) {
    const size_t tile = get_global_id(0) / TILE_ROW, row = get_global_id(0) % TILE_ROW;
    t += tile * coefficients * TILE_ROW + row;
    scratch += tile * coefficients * TILE_ROW + row;
    for (uint n = coefficients, step = 0; n >= 4 && step < steps; n /= 2, step++) {
        for (uint k = 0; k < n / 2; k++) {
            const float16 a = t[(2 * k) * TILE_ROW], b = t[(2 * k + 1) * TILE_ROW];
            const float16 c = t[((2 * k + 2) % n) * TILE_ROW], d = t[((2 * k + 3) % n) * TILE_ROW];
            scratch[k * TILE_ROW] = D1 * a + D2 * b + D3 * c + D4 * d;
            scratch[(n / 2 + k) * TILE_ROW] = D4 * a - D3 * b + D2 * c - D1 * d;
        }
        for (uint k = 0; k < n; k++)
            t[k * TILE_ROW] = scratch[k * TILE_ROW];
    }
}
