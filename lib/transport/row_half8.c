// SPDX-License-Identifier: Apache-2.0
#include "transport/row_pack.h"

static void encode(const float *values, void *out) {
    row_pack_means(values, 8, out);
}

static void decode(const void *in, float *values) {
    row_unpack_means(in, 8, values);
}

static void add(const void *in, const float *weight, struct row_sums *sums) {
    row_add_packed(in, ROW_MEANS / ROW_CHANNELS, 8, weight, sums->mean, sums->base);
}

const struct row_way row_half8 = {"half8", "means of 2x2 pixels, of 8 bits",
                                64, encode, decode, add};
