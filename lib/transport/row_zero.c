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

const struct row_way row_zero = {"zero", "nothing is stored", 0, encode, decode};
