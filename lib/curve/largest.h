// SPDX-License-Identifier: Apache-2.0
// Non-linear approximation: keeping the coefficients of largest magnitude, whichever they are, and
// none of the others (Ng, Ramamoorthi, Hanrahan 2003, unweighted selection).
#pragma once

#include <stdint.h>

// weights[count][3]; the size of a coefficient is the root of the sum of squares of its channels.
void keep_largest(float *weights, uint32_t count, uint32_t keep);
