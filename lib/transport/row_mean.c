// SPDX-License-Identifier: Apache-2.0
#include "transport/rows.h"

static void encode(const float *values, void *out) {
    float *mean = out;
    for (int c = 0; c < ROW_CHANNELS; c++) {
        double sum = 0;
        for (int i = 0; i < ROW_LANES; i++)
            sum += (double)values[c * ROW_LANES + i];
        mean[c] = (float)(sum / ROW_LANES);
    }
    mean[3] = 0;
}

static void decode(const void *in, float *values) {
    for (int i = 0; i < ROW_VALUES; i++)
        values[i] = ((const float *)in)[i / ROW_LANES];
}

static void add(const void *in, const float *weight, struct row_sums *sums) {
    for (int c = 0; c < ROW_CHANNELS; c++)
        sums->base[c] += weight[c] * ((const float *)in)[c];
}

const struct row_way row_mean = {"mean", "one value a channel", 16, encode, decode, add};
