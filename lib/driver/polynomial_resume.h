// SPDX-License-Identifier: Apache-2.0
// Going on from a polynomial tensor that kept its sums, and when to stop.
#pragma once

#include "driver/precompute_polynomial.h"

// The unit that sums are multiples of: a power of two, about 2^-30 of the picture's mean radiance. It
// depends on scene and options, not on the range of samples.
double polynomial_quantum(const struct polynomial *p);

// Opens the output, if it is there, and tells where its samples end. meta: those of a tensor that
// these options make. false after an error message: they would not have made it.
bool polynomial_resume(const struct polynomial_options *o, const struct json *meta, uint32_t first,
                       struct tensor_file **base, uint32_t *next);

// What the half-sums of a tensor tell of the picture as the materials are: what `render` calls noise.
// false after an error message.
bool polynomial_noise(const char *path, int threads, double *noise);
