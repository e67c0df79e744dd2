// SPDX-License-Identifier: Apache-2.0
// Orthonormal wavelet transforms of curves and of what is stored per curve coefficient.
//
// Haar and Daubechies-4 (Daubechies 1988), periodised: the signal goes on at its end with its
// start. A power of two of values is replaced by 1 (Haar) or 2 (Daubechies-4) means of the coarsest
// level, then details from coarse to fine. The transform S is orthonormal, so that
// dot(a, b) = dot(S a, S b), its inverse is its transpose, and a matrix goes by rows, then columns.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum wavelet { WAVELET_HAAR, WAVELET_DAUB4, WAVELET_COUNT };

extern const char *const wavelet_names[]; // "haar", "daub4", NULL

static inline bool wavelet_fits(size_t n) {
    return n > 0 && (n & (n - 1)) == 0;
}

// In place; wavelet_fits(n); scratch holds n values.
void wavelet_forward_d(enum wavelet w, double *x, size_t n, double *scratch);
void wavelet_inverse_d(enum wavelet w, double *x, size_t n, double *scratch);
void wavelet_forward_f(enum wavelet w, float *x, size_t n, float *scratch);
void wavelet_inverse_f(enum wavelet w, float *x, size_t n, float *scratch);

// The matrix x[rows][columns] to S x S^T (and back); scratch holds 2 max(rows, columns) values.
void wavelet_forward_matrix(enum wavelet w, double *x, size_t rows, size_t columns,
                            double *scratch);
void wavelet_inverse_matrix(enum wavelet w, double *x, size_t rows, size_t columns,
                            double *scratch);
