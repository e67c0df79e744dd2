// SPDX-License-Identifier: Apache-2.0
// The metadata of a polynomial tensor: what its coefficients are multiplied by, and what they depend on.
#pragma once

#include "driver/precompute_polynomial.h"

// Finds the equivalent albedos of all terms, which the metadata tell and later hops are scaled by.
void polynomial_albedos(struct polynomial *p, int threads);

// Of samples [first, end); quantum: of a tensor that keeps its sums.
struct json *polynomial_describe(const struct polynomial *p, const struct polynomial_options *o,
                                 uint32_t first, uint32_t end, double quantum);
