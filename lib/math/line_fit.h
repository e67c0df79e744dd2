// SPDX-License-Identifier: Apache-2.0
// A straight line through points, for exponents of power laws in logarithms.
#pragma once

#include <stdbool.h>

struct line_fit {
    double slope, intercept;
    double slope_error; // standard error; NaN: not known
};

// Least squares of y over x. errors: standard errors of y, or NULL; if all are known, points of larger
// error count less: weights are 1 / (error^2 + median error^2), since errors are estimates themselves.
// The slope's error is the larger of what they and what the scatter about the line say (the latter
// needs 3 points).
// false: fewer than two different x.
bool line_fit(const double *x, const double *y, const double *errors, int count,
              struct line_fit *out);
