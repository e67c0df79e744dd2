// SPDX-License-Identifier: Apache-2.0
// Do two pictures agree within their noise? Three tests of decreasing resolution: every pixel
// value, means of 8x8 blocks, the mean of the picture. The first finds wrong spots, the last a
// small uniform bias, which the first cannot see.
//
// All in CIE XYZ, as Mitsuba 3's render tests. Per value: z = |test - ref| sqrt(N / max(var, 1e-4)),
// two-sided p-value, agreement when p > 1 - 0.99^(1/pixels) (Sidak's correction of a 1 % level); the
// picture passes when at least 99.75 % of its values agree. Mitsuba's references are taken to be free
// of noise there; for one that is not, 1/N + 1/ref_samples stands for 1/N. Where both pictures tell the
// error of each of their values, these errors stand for all of that, and nothing is scaled by numbers
// of samples: the variance of Sobol points falls faster than 1/N. Errors that are the spread of few
// replicates are themselves uncertain: z then is Student's t, with the degrees of freedom of Welch
// (1947, The Generalization of Student's Problem).
//
// Block and picture means: noise of both pictures, with values of different pixels taken as independent
// (a box filter), a floor for rounding of max(16, sqrt(ref_samples)) ulp of the mean, and the same
// correction for the number of means tested.
//
// No test knows of light that no replicate of a pixel has met: such a value is told too dark and too
// certain.
#pragma once

#include "image/image.h"

struct ztest_input {
    const struct image *ref, *test; // linear Rec.709, 3 channels, equal sizes
    const struct image *variance;   // of a single-sample estimate of each value of ref
    bool variance_of_rgb;           // not, as Mitsuba's, of X, Y and Z, turned to RGB like a colour
    double samples;                 // N, per pixel of test
    double ref_samples;             // per pixel of ref; infinite: ref has no noise
    bool pixels_of_noisy_ref;       // the test of pixels, too, counts ref's noise
    const struct image *ref_variance, *test_variance; // squared standard errors of their values;
                                                      // NULL: variance over the samples
    int replicates; // that these and `variance` were found from; 0: they are exact
};

struct ztest_level {
    size_t values, agreeing; // three values a pixel or block; non-finite ones never agree
    double share;            // agreeing / values
    double largest_z;        // or t
    double p_limit;          // a value agrees above it: by noise alone all but this share do
    double least_share;      // to pass
    bool pass;
};

struct ztest_result {
    struct ztest_level pixels, blocks, mean;
    double relative_difference; // of mean Y: (test - ref) / ref
    double relative_error;      // its standard error
    bool pass;                  // all three
};

void ztest_run(const struct ztest_input *in, struct ztest_result *out);
