// SPDX-License-Identifier: Apache-2.0
// What repeated runs tell of a method: squared error, and its parts from bias and from variance.
//
// With runs a_i = t + b + n_i (truth t, bias b, independent noise n_i) and a reference r = t + d, let
//     G_ij = mean over the values of a picture of w (a_i - r)(a_j - r).
// Products of two different runs have the expectation b^2 + d^2, those of a run with itself b^2 + n^2
// + d^2: no squared noise is taken for bias. The three results are means over pairs of runs
// (U-statistics: W. Hoeffding, "A Class of Statistics with Asymptotically Normal Distribution",
// 1948), so bias2 may come out negative where there is none.
#pragma once

struct measured {
    double value;
    double error;     // standard error; NaN: not known
    double low, high; // 95 % confidence interval
};

struct repeats {
    struct measured mse;      // of one run: bias2 + variance
    struct measured bias2;    // squared bias
    struct measured variance; // of one run
};

// gram: runs x runs values G. reference_noise: the mean of w d^2 as it is expected; reference_error:
// the standard error that the reference's noise leaves in bias2 and mse. Standard errors need 3 runs;
// with 3 they are too large rather than too small. They hold too where the pixels of a run are not
// independent of each other.
struct repeats repeats_measure(const double *gram, int runs, double reference_noise,
                               double reference_error);
