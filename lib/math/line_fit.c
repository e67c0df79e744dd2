// SPDX-License-Identifier: Apache-2.0
#include "math/line_fit.h"

#include <math.h>
#include <stddef.h>

// The value below which half of them lie (the lower of the two in the middle).
static double median(const double *v, int count) {
    for (int i = 0; i < count; i++) {
        int below = 0, equal = 0;
        for (int j = 0; j < count; j++) {
            below += v[j] < v[i];
            equal += v[j] == v[i];
        }
        if (below <= (count - 1) / 2 && below + equal > (count - 1) / 2)
            return v[i];
    }
    return NAN; // some are
}

// typical == 0: all count alike.
static double weight(const double *errors, double typical, int i) {
    return typical > 0 ? 1 / (errors[i] * errors[i] + typical * typical) : 1;
}

bool line_fit(const double *x, const double *y, const double *errors, int count,
              struct line_fit *out) {
    double typical = errors ? median(errors, count) : 0;
    double sum = 0, mean_x = 0, mean_y = 0, xx = 0, xy = 0, left = 0, known = 0;
    for (int i = 0; errors && i < count; i++)
        typical = isfinite(errors[i]) ? typical : 0;
    for (int i = 0; i < count; i++) {
        sum += weight(errors, typical, i);
        mean_x += weight(errors, typical, i) * x[i];
        mean_y += weight(errors, typical, i) * y[i];
    }
    mean_x /= sum;
    mean_y /= sum;
    for (int i = 0; i < count; i++) {
        xx += weight(errors, typical, i) * (x[i] - mean_x) * (x[i] - mean_x);
        xy += weight(errors, typical, i) * (x[i] - mean_x) * (y[i] - mean_y);
    }
    if (count < 2 || !(xx > 1e-12 * sum * mean_x * mean_x))
        return false;
    out->slope = xy / xx;
    out->intercept = mean_y - out->slope * mean_x;
    for (int i = 0; i < count; i++) {
        const double d = y[i] - out->intercept - out->slope * x[i];
        const double w = weight(errors, typical, i);
        const double share = errors ? w * (x[i] - mean_x) / xx * errors[i] : NAN;
        left += w * d * d;
        known += share * share;
    }
    const double scatter = count > 2 ? left / (count - 2) / xx : NAN;
    out->slope_error = sqrt(fmax(known, scatter)); // fmax: the number, if one is NaN
    return true;
}
