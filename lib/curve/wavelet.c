// SPDX-License-Identifier: Apache-2.0
#include "curve/wavelet.h"

#include <assert.h>
#include <string.h>

const char *const wavelet_names[] = {"haar", "daub4", NULL};

struct filter {
    size_t taps;
    double low[4], high[4];
};

#define HALF_ROOT 0.7071067811865475244
#define D1 0.4829629131445341434  // (1 + sqrt 3) / (4 sqrt 2)
#define D2 0.8365163037378079056  // (3 + sqrt 3) / (4 sqrt 2)
#define D3 0.2241438680420133810  // (3 - sqrt 3) / (4 sqrt 2)
#define D4 -0.1294095225512603812 // (1 - sqrt 3) / (4 sqrt 2)

static const struct filter filters[WAVELET_COUNT] = {
    [WAVELET_HAAR] = {2, {HALF_ROOT, HALF_ROOT}, {HALF_ROOT, -HALF_ROOT}},
    [WAVELET_DAUB4] = {4, {D1, D2, D3, D4}, {D4, -D3, D2, -D1}},
};

#define REAL double
#define R(name) name##_d
#include "curve/wavelet.inc"
#undef REAL
#undef R
#define REAL float
#define R(name) name##_f
#include "curve/wavelet.inc"
#undef REAL
#undef R

typedef void (*transform_fn)(enum wavelet w, double *x, size_t n, double *scratch);

static void transform_rows(transform_fn f, enum wavelet w, double *x, size_t rows, size_t columns,
                           double *scratch) {
    for (size_t r = 0; r < rows; r++)
        f(w, x + r * columns, columns, scratch);
}

static void transform_columns(transform_fn f, enum wavelet w, double *x, size_t rows,
                              size_t columns, double *scratch) {
    double *column = scratch + rows;
    for (size_t c = 0; c < columns; c++) {
        for (size_t r = 0; r < rows; r++)
            column[r] = x[r * columns + c];
        f(w, column, rows, scratch);
        for (size_t r = 0; r < rows; r++)
            x[r * columns + c] = column[r];
    }
}

void wavelet_forward_matrix(enum wavelet w, double *x, size_t rows, size_t columns,
                            double *scratch) {
    transform_rows(wavelet_forward_d, w, x, rows, columns, scratch);
    transform_columns(wavelet_forward_d, w, x, rows, columns, scratch);
}

void wavelet_inverse_matrix(enum wavelet w, double *x, size_t rows, size_t columns,
                            double *scratch) {
    transform_columns(wavelet_inverse_d, w, x, rows, columns, scratch);
    transform_rows(wavelet_inverse_d, w, x, rows, columns, scratch);
}
