// SPDX-License-Identifier: Apache-2.0
// Half the resolution: means of four lanes, which are 2x2 pixels where the list is in Z order.
#include "transport/row_pack.h"

enum { MEANS = ROW_VALUES / 4, BITS = 4 };

static void encode(const float *values, void *out) {
    float mean[MEANS];
    for (int i = 0; i < MEANS; i++)
        mean[i] = 0.25f * (values[4 * i] + values[4 * i + 1] + values[4 * i + 2] + values[4 * i + 3]);
    row_pack(mean, MEANS / 3, BITS, out);
}

static void decode(const void *in, float *values) {
    float mean[MEANS];
    row_unpack(in, MEANS / 3, BITS, mean);
    for (int i = 0; i < ROW_VALUES; i++)
        values[i] = mean[i / 4];
}

const struct row_way row_half4 = {"half4", "means of 2x2 pixels, of 4 bits",
                                48, encode, decode};
