// SPDX-License-Identifier: Apache-2.0
// Going on from a polynomial tensor that kept its sums.
#pragma once

#include "driver/precompute_polynomial.h"

// The unit that sums are multiples of: a power of two, about 2^-30 of the picture's mean radiance. It
// depends on scene and options, not on the range of samples.
double polynomial_quantum(const struct polynomial *p);

// Adds to the metadata what is needed to go on: "ranges", [[first, end]], and what sums depend on.
void polynomial_resume_describe(struct json *meta, const struct polynomial *p, uint32_t first,
                                uint32_t end, double quantum);

// Opens the output, if it is there, and tells where its samples end. false after an error message: it
// is not what these options would have made.
bool polynomial_resume(const struct polynomial *p, const struct polynomial_options *o,
                       uint32_t first, double quantum, struct tensor_file **base, uint32_t *next);
