// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "transport/rows.h"

static void encode(const float *values, void *out) {
    (void)values;
    (void)out;
}

static void decode(const void *in, float *values) {
    (void)in;
    memset(values, 0, ROW_VALUES * sizeof *values);
}

static void add(const void *in, const float *weight, struct row_sums *sums) {
    (void)in;
    (void)weight;
    (void)sums;
}

const struct row_way row_zero = {"zero", "nothing is stored", 0, encode, decode, add};
