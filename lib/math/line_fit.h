// SPDX-License-Identifier: Apache-2.0
// A straight line through points, for exponents of power laws in logarithms.
#pragma once

#include <stdbool.h>

struct line_fit {
    double slope, intercept;
    double slope_error; // standard error; NaN: not known
};

// Least squares of y over x. errors: standard errors of y (NaN: not known), or NULL. The slope's error
// is the larger of what they and what the scatter about the line say (the latter needs 3 points).
// false: fewer than two different x.
bool line_fit(const double *x, const double *y, const double *errors, int count,
              struct line_fit *out);
