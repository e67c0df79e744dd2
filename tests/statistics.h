// SPDX-License-Identifier: Apache-2.0
// P-values for tests of random numbers, and the correction for making many of them.
#pragma once

#include <math.h>

// Upper regularised incomplete gamma function Q(a, x) by series or continued fraction (Press et
// al. 2007, Numerical Recipes, 6.2).
static inline double gamma_q(double a, double x) {
    if (!(x > 0))
        return 1;
    const double scale = exp(-x + a * log(x) - lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (int n = 1; n < 1000 && term > 1e-15 * sum; n++) {
            term *= x / (a + n);
            sum += term;
        }
        return 1 - scale * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int n = 1; n < 1000; n++) {
        const double an = -n * (n - a);
        b += 2;
        d = 1 / fmax(fabs(an * d + b), 1e-300) * copysign(1, an * d + b);
        c = b + an / c;
        const double delta = d * c;
        h *= delta;
        if (fabs(delta - 1) < 1e-14)
            break;
    }
    return scale * h;
}

// Probability that chi-square with that many degrees of freedom exceeds the statistic.
static inline double chi2_p_value(double statistic, int degrees) {
    return degrees > 0 ? gamma_q(0.5 * degrees, 0.5 * statistic) : 1;
}

// Two-sided p-value of a normal deviate.
static inline double normal_p_value(double z) {
    return erfc(fabs(z) * 0.70710678118654752);
}

// Significance of each of n independent tests so that all together raise a false alarm with the
// probability alpha (Sidak 1967).
static inline double sidak(double alpha, int n) {
    return -expm1(log1p(-alpha) / n);
}

struct chi2_bins {
    double statistic;
    double pooled_expected, pooled_observed; // bins too small to stand alone
    int degrees;
    double slack; // error of the pooled bins' expected count; at least 1 is allowed for
};

enum { CHI2_LEAST = 10 }; // expected count of a bin that stands alone

static inline void chi2_add(struct chi2_bins *b, double observed, double expected) {
    if (expected < CHI2_LEAST) {
        b->pooled_expected += expected;
        b->pooled_observed += observed;
        return;
    }
    b->statistic += (observed - expected) * (observed - expected) / expected;
    b->degrees++;
}

// P-value after all bins of a complete partition were added.
static inline double chi2_finish(struct chi2_bins *b) {
    if (b->pooled_expected >= CHI2_LEAST) {
        const double d = b->pooled_observed - b->pooled_expected;
        b->statistic += d * d / b->pooled_expected;
        b->degrees++;
    } else if (b->pooled_observed > 0) { // few are expected: Poisson tail, as its own test
        const double p = 1 - gamma_q(b->pooled_observed, b->pooled_expected + fmax(b->slack, 1));
        if (p < 1e-9)
            return p;
    }
    return chi2_p_value(b->statistic, b->degrees - 1);
}
