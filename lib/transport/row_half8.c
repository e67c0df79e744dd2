// SPDX-License-Identifier: Apache-2.0
#include "transport/row_pack.h"

static void encode(const float *values, void *out) {
    row_pack_means(values, 8, out);
}

static void decode(const void *in, float *values) {
    row_unpack_means(in, 8, values);
}

const struct row_way row_half8 = {"half8", "means of 2x2 pixels, of 8 bits",
                                64, encode, decode};
