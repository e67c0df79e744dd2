// SPDX-License-Identifier: Apache-2.0
// Three mantissas of 8 bits with one exponent of 8 bits a pixel (Ward 1991), rounded to nearest; in
// planes R, G, B, E. Negative values become zero, as do pixels below 2^-118.
#include <math.h>
#include <string.h>

#include "transport/rows.h"

enum { LEAST_EXPONENT = 10, BIAS = 128, FLOAT_STEP = 9 }; // 2^(E - 136), as a float's exponent

static float unit_of(uint32_t e) {
    const uint32_t u = (e < FLOAT_STEP ? 0 : e - FLOAT_STEP) << 23;
    float f;
    memcpy(&f, &u, sizeof f);
    return f;
}

static void encode(const float *values, void *out) {
    uint8_t *p = out;
    for (int i = 0; i < ROW_LANES; i++) {
        int e;
        const float most = fmaxf(values[i], fmaxf(values[ROW_LANES + i], values[2 * ROW_LANES + i]));
        const float f = frexpf(fmaxf(most, 0), &e);
        e += BIAS + (f * 256 >= 255.5f);
        const bool none = most <= 0 || e < LEAST_EXPONENT;
        e = e > 255 ? 255 : e;
        p[3 * ROW_LANES + i] = none ? 0 : (uint8_t)e;
        for (int c = 0; c < 3; c++) {
            const float m = none ? 0 : rintf(values[c * ROW_LANES + i] / unit_of((uint32_t)e));
            p[c * ROW_LANES + i] = (uint8_t)fminf(fmaxf(m, 0), 255);
        }
    }
}

static void decode(const void *in, float *values) {
    const uint8_t *p = in;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < ROW_LANES; i++)
            values[c * ROW_LANES + i] = p[c * ROW_LANES + i] * unit_of(p[3 * ROW_LANES + i]);
}

static void add(const void *in, const float *weight, struct row_sums *sums) {
    float values[ROW_VALUES];
    decode(in, values);
    row_add_values(values, weight, sums);
}

const struct row_way row_rgbe = {"rgbe", "8 bits a value and an exponent a pixel", 4 * ROW_LANES,
                                 encode, decode, add};
