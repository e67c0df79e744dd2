// SPDX-License-Identifier: Apache-2.0
// The layout of coefficients that kernels and their C twins share.
//
// [tile][coefficient][channel][64 lanes]: one work-item does a tile and reads it from one end to the
// other, so that it runs at the speed of memory; four vectors of 16 make the 64 lanes. Sums run over
// coefficients in order and nothing is fused, so that kernel and twin agree bit for bit.
#pragma once

#define TILE_LANES 64
#define TILE_VECTORS 4
#define TILE_CHANNELS 3
#define TILE_ROW (TILE_CHANNELS * TILE_VECTORS)
#define TILE_REDUCED 64 // coefficients that a work-item of contract makes: 48 kB
