// SPDX-License-Identifier: Apache-2.0
#include "math/line_fit.h"

#include <math.h>

bool line_fit(const double *x, const double *y, const double *errors, int count,
              struct line_fit *out) {
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0, left = 0, known = 0;
    for (int i = 0; i < count; i++) {
        mean_x += x[i] / count;
        mean_y += y[i] / count;
    }
    for (int i = 0; i < count; i++) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    if (!(xx > 1e-12 * mean_x * mean_x) || count < 2)
        return false;
    out->slope = xy / xx;
    out->intercept = mean_y - out->slope * mean_x;
    for (int i = 0; i < count; i++) {
        const double d = y[i] - out->intercept - out->slope * x[i];
        const double share = errors ? (x[i] - mean_x) / xx * errors[i] : NAN;
        left += d * d;
        known += share * share;
    }
    const double scatter = count > 2 ? left / (count - 2) / xx : NAN;
    out->slope_error = sqrt(fmax(known, scatter)); // fmax: the number, if one is NaN
    return true;
}
