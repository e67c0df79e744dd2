// SPDX-License-Identifier: Apache-2.0
// The operations of the runtime on tiles of coefficients: each is an OpenCL kernel (kernels/) with a
// C twin of the same name that gives the same bits.
//
// Layouts are those of kernels/tile.h. A twin runs on all threads; it is what runs where there is no
// device.
#pragma once

#include "replay/contraction.h"

// out[tile][channel][lane] = sum_c weight[c][channel] T[tile][c][channel][lane]
void tiles_dot(struct tensor_data t, const float *weight, uint32_t coefficients, size_t tiles,
               float *out, int threads);
// out[tile][channel][lane] += sum_k weight[k][channel] T[tile][term[k]][channel][lane]
void tiles_add_terms(struct tensor_data t, const float *weight,
                     const uint32_t *term, uint32_t terms, uint32_t coefficients, size_t tiles,
                     float *out, int threads);

// out[tile][channel][lane] = sum_l layer[l][tile][channel][lane]
void tiles_add_layers(const float *layer, uint32_t layers, size_t tiles, float *out, int threads);

// out[tile][target[i]][channel][lane] += weight[i][channel] T[tile][index[i]][channel][lane], from 0 on
void tiles_contract(struct tensor_data t, const struct contraction *c, uint32_t coefficients,
                    size_t tiles, float *out, int threads);
// Periodic Daubechies-4 transform over the coefficients of each lane, in place; coefficients a power
// of two; scratch as large as t.
void tiles_daubechies4(float *t, float *scratch, uint32_t coefficients, uint32_t steps,
                       size_t tiles, int threads);
// frame[channel][pixel[i]] += scale[channel] factor[tile][channel][lane] out[tile][channel][lane];
// factor NULL: 1. plane: pixels of a channel of the frame.
void tiles_compose(const float *out, const uint32_t *pixel, uint32_t pixels, const float scale[3],
                   const float *factor, float *frame, uint32_t plane, int threads);
// rgba[pixel] = 8-bit sRGB of exposure * frame, alpha 255; NaN is black.
void tiles_tone_map(const float *frame, uint32_t plane, float exposure, uint8_t *rgba, int threads);
