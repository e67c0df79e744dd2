// SPDX-License-Identifier: Apache-2.0
#include "transport/bfloat16.h"
#include "transport/rows.h"

static void encode(const float *values, void *out) {
    for (int i = 0; i < ROW_VALUES; i++)
        ((uint16_t *)out)[i] = bf16_from_float(values[i]);
}

static void decode(const void *in, float *values) {
    for (int i = 0; i < ROW_VALUES; i++)
        values[i] = bf16_to_float(((const uint16_t *)in)[i]);
}

static void add(const void *in, const float *weight, struct row_sums *sums) {
    float values[ROW_VALUES];
    decode(in, values);
    row_add_values(values, weight, sums);
}

const struct row_way row_bfloat16 = {"bfloat16", "16 bits a value", 2 * ROW_VALUES, encode, decode, add};
