// SPDX-License-Identifier: Apache-2.0
#include "transport/row_pack.h"

static void encode(const float *values, void *out) {
    row_pack(values, ROW_LANES, 4, out);
}

static void decode(const void *in, float *values) {
    row_unpack(in, ROW_LANES, 4, values);
}

static void add(const void *in, const float *weight, struct row_sums *sums) {
    row_add_packed(in, ROW_LANES, 4, weight, sums->lane, sums->base);
}

const struct row_way row_int4 = {"int4", "4 bits a value between a channel's ends in the row",
                               16 + ROW_VALUES * 4 / 8, encode, decode, add};
