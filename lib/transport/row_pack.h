// SPDX-License-Identifier: Apache-2.0
// Rows of whole numbers: per channel the lowest value and the step, as two bfloat16 (16 bytes in
// all), then numbers of `bits` bits. A byte holds 8 / bits of them, low bits first, that are as far
// apart as there are bytes, so that neighbours are unpacked alike.
#pragma once

#include "transport/bfloat16.h"
#include "transport/rows.h"

enum { ROW_HEAD = 16 };

void row_pack(const float *values, uint32_t per_channel, uint32_t bits, void *out);

static inline void row_unpack_numbers(const void *in, uint32_t per_channel, uint32_t bits, float *q) {
    const uint32_t stride = ROW_CHANNELS * per_channel * bits / 8, mask = (1u << bits) - 1;
    const uint8_t *packed = (const uint8_t *)in + ROW_HEAD;
    for (uint32_t shift = 0; shift < 8; shift += bits)
        for (uint32_t i = 0; i < stride; i++)
            q[shift / bits * stride + i] = (float)(packed[i] >> shift & mask);
}

static inline void row_unpack(const void *in, uint32_t per_channel, uint32_t bits, float *values) {
    const uint16_t *head = in;
    row_unpack_numbers(in, per_channel, bits, values);
    for (uint32_t c = 0; c < ROW_CHANNELS; c++) {
        const float lo = bf16_to_float(head[2 * c]), step = bf16_to_float(head[2 * c + 1]);
        for (uint32_t i = c * per_channel; i < (c + 1) * per_channel; i++)
            values[i] = lo + step * values[i];
    }
}

// Adds the row times weights, its lowest values apart.
static inline void row_add_packed(const void *in, uint32_t per_channel, uint32_t bits, const float *weight,
                                  float *restrict sum, float *restrict base) {
    float q[ROW_VALUES];
    const uint16_t *head = in;
    row_unpack_numbers(in, per_channel, bits, q);
    for (uint32_t c = 0; c < ROW_CHANNELS; c++) {
        const float step = weight[c] * bf16_to_float(head[2 * c + 1]);
        base[c] += weight[c] * bf16_to_float(head[2 * c]);
        for (uint32_t i = c * per_channel; i < (c + 1) * per_channel; i++)
            sum[i] += step * q[i];
    }
}

// Half the resolution: means of four lanes, which are 2x2 pixels where the list is in Z order.
void row_pack_means(const float *values, uint32_t bits, void *out);

static inline void row_unpack_means(const void *in, uint32_t bits, float *values) {
    float mean[ROW_MEANS];
    row_unpack(in, ROW_MEANS / ROW_CHANNELS, bits, mean);
    for (int i = 0; i < ROW_VALUES; i++)
        values[i] = mean[i / 4];
}
