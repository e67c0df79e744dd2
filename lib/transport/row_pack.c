// SPDX-License-Identifier: Apache-2.0
#include "transport/row_pack.h"

#include <math.h>
#include <string.h>

// The next bfloat16 that is not above, or not below.
static uint16_t bf16_down(float f) {
    const uint16_t h = bf16_from_float(f);
    if (bf16_to_float(h) <= f)
        return h;
    return (uint16_t)(h == 0 ? 0x8001 : h >> 15 ? h + 1 : h - 1);
}

static uint16_t bf16_up(float f) {
    return bf16_down(-f) ^ 0x8000;
}

void row_pack(const float *values, uint32_t per_channel, uint32_t bits, void *out) {
    const uint32_t count = ROW_CHANNELS * per_channel, stride = count * bits / 8;
    const float most = (float)((1u << bits) - 1);
    uint16_t *head = out;
    uint8_t *packed = (uint8_t *)out + ROW_HEAD;
    memset(out, 0, ROW_HEAD + stride);
    for (uint32_t c = 0; c < ROW_CHANNELS; c++) {
        float lo = values[c * per_channel], hi = lo;
        for (uint32_t i = 1; i < per_channel; i++) {
            lo = fminf(lo, values[c * per_channel + i]);
            hi = fmaxf(hi, values[c * per_channel + i]);
        }
        head[2 * c] = bf16_down(lo);
        lo = bf16_to_float(head[2 * c]);
        head[2 * c + 1] = hi > lo ? bf16_up((hi - lo) / most) : 0;
        const float step = bf16_to_float(head[2 * c + 1]);
        for (uint32_t i = c * per_channel; i < (c + 1) * per_channel; i++) {
            const float q = step > 0 ? rintf((values[i] - lo) / step) : 0;
            packed[i % stride] |= (uint8_t)((uint32_t)fminf(fmaxf(q, 0), most) << i / stride * bits);
        }
    }
}

void row_pack_means(const float *values, uint32_t bits, void *out) {
    float mean[ROW_MEANS];
    for (int i = 0; i < ROW_MEANS; i++)
        mean[i] = 0.25f * (values[4 * i] + values[4 * i + 1] + values[4 * i + 2] + values[4 * i + 3]);
    row_pack(mean, ROW_MEANS / ROW_CHANNELS, bits, out);
}
