// SPDX-License-Identifier: Apache-2.0
// Rows of whole numbers: per channel the lowest value and the step, as two bfloat16 (16 bytes in
// all), then numbers of `bits` bits. A byte holds 8 / bits of them, low bits first, that are as far
// apart as there are bytes, so that neighbours are unpacked alike.
#pragma once

#include "transport/bfloat16.h"
#include "transport/rows.h"

enum { ROW_CHANNELS = 3, ROW_HEAD = 16, ROW_MEANS = ROW_VALUES / 4 };

void row_pack(const float *values, uint32_t per_channel, uint32_t bits, void *out);

static inline void row_unpack(const void *in, uint32_t per_channel, uint32_t bits, float *values) {
    const uint32_t stride = ROW_CHANNELS * per_channel * bits / 8, mask = (1u << bits) - 1;
    const uint16_t *head = in;
    const uint8_t *packed = (const uint8_t *)in + ROW_HEAD;
    for (uint32_t shift = 0; shift < 8; shift += bits)
        for (uint32_t i = 0; i < stride; i++)
            values[shift / bits * stride + i] = (float)(packed[i] >> shift & mask);
    for (uint32_t c = 0; c < ROW_CHANNELS; c++) {
        const float lo = bf16_to_float(head[2 * c]), step = bf16_to_float(head[2 * c + 1]);
        for (uint32_t i = c * per_channel; i < (c + 1) * per_channel; i++)
            values[i] = lo + step * values[i];
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
