// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "transport/rows.h"

static void encode(const float *values, void *out) {
    memcpy(out, values, ROW_VALUES * sizeof *values);
}

static void decode(const void *in, float *values) {
    memcpy(values, in, ROW_VALUES * sizeof *values);
}

static void add(const void *in, const float *weight, struct row_sums *sums) {
    row_add_values(in, weight, sums);
}

const struct row_way row_float32 = {"float32", "as it is", 4 * ROW_VALUES, encode, decode, add};
