// SPDX-License-Identifier: Apache-2.0
// From sums of blocks to a picture.
//
//     compose:  frame[channel][pixel[i]] += scale[channel] factor[tile][channel][lane] out[tile][...]
//     tone_map: rgba[pixel] = 8-bit sRGB of exposure * frame, alpha 255
//
// i = tile * 64 + lane. compose: one work-item a tile; a list names a pixel once, so no two meet.
// tone_map: one work-item a pixel.
#if !defined(__OPENCL_C_VERSION__)
#error "OpenCL C is expected"
#endif
#pragma OPENCL FP_CONTRACT OFF
#include "kernels/tile.h"

kernel void compose(global const float *out, global const uint *pixel, uint pixels,
                    global const float *scale, global const float *factor, uint has_factor,
                    global float *frame, uint plane) {
    const uint tile = get_global_id(0), first = tile * TILE_LANES;
    const uint lanes = min((uint)TILE_LANES, pixels - first);
    out += (size_t)tile * TILE_CHANNELS * TILE_LANES;
    factor += has_factor ? (size_t)tile * TILE_CHANNELS * TILE_LANES : 0;
    for (uint channel = 0; channel < TILE_CHANNELS; channel++)
        for (uint lane = 0; lane < lanes; lane++) {
            const uint i = channel * TILE_LANES + lane;
            const float value = has_factor ? scale[channel] * factor[i] * out[i]
                                           : scale[channel] * out[i];
            frame[(size_t)channel * plane + pixel[first + lane]] += value;
        }
}

float srgb(float v) {
    v = v > 0 ? v : 0; // NaN too
    v = v <= 0.0031308f ? 12.92f * v : 1.055f * pow(v, 1 / 2.4f) - 0.055f;
    return v < 1 ? v : 1;
}

kernel void tone_map(global const float *frame, uint plane, float exposure, global uchar4 *rgba) {
    const size_t i = get_global_id(0);
    const float r = srgb(exposure * frame[i]), g = srgb(exposure * frame[plane + i]);
    const float b = srgb(exposure * frame[2 * (size_t)plane + i]);
    rgba[i] = (uchar4)((uchar)(255 * r + 0.5f), (uchar)(255 * g + 0.5f), (uchar)(255 * b + 0.5f), 255);
}
