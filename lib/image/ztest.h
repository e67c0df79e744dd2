// SPDX-License-Identifier: Apache-2.0
// Do two pictures agree within their noise? Three tests of decreasing resolution: every pixel
// value, means of 8x8 blocks, the mean of the picture. The first finds wrong spots, the last a
// small uniform bias, which the first cannot see.
//
// All in CIE XYZ, as Mitsuba 3's render tests. Per value: z = |test - ref| sqrt(N / max(var, 1e-4)),
// two-sided p-value, agreement when p > 1 - 0.99^(1/pixels) (Sidak's correction of a 1 % level); the
// picture passes when at least 99.75 % of its values agree. Mitsuba's references are taken to be free
// of noise there; for one that is not, 1/N + 1/ref_samples stands for 1/N. Block and picture means: noise of both
// pictures, with values of different pixels taken as independent (a box filter), a floor for
// rounding of max(16, sqrt(ref_samples)) ulp of the mean, and the same correction for the number of
// means tested.
#pragma once

#include "image/image.h"

struct ztest_input {
    const struct image *ref, *test; // linear Rec.709, 3 channels, equal sizes
    const struct image *variance;   // of a single-sample estimate of each value of ref
    bool variance_of_rgb;           // not, as Mitsuba's, of X, Y and Z, turned to RGB like a colour
    double samples;                 // N, per pixel of test
    double ref_samples;             // per pixel of ref; infinite: ref has no noise
    bool pixels_of_noisy_ref;       // the test of pixels, too, counts ref's noise
    const struct image *test_variance; // squared standard error of test's values, for the means;
                                       // NULL: variance / samples
};

struct ztest_level {
    size_t values, agreeing; // three values a pixel or block; non-finite ones never agree
    double share;            // agreeing / values
    double largest_z;
    double p_limit;          // a value agrees above it
    bool pass;
};

struct ztest_result {
    struct ztest_level pixels, blocks, mean;
    double relative_difference; // of mean Y: (test - ref) / ref
    double relative_error;      // its standard error
    bool pass;                  // all three
};

void ztest_run(const struct ztest_input *in, struct ztest_result *out);

// Two-sided p-value of a standard normal z.
double ztest_p_value(double z);
