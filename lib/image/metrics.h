// SPDX-License-Identifier: Apache-2.0
// How far a picture is from its reference, with the noise of both taken into account.
//
// Pictures are linear Rec.709, 3 channels, of equal size. Sums run in double over all values.
// Non-finite values of either picture are left out and counted.
//
// Errors: a picture's `variance`, where known, is the squared standard error of each value (what
// `render --variance` writes). An estimate then carries the standard error that this noise gives
// it, with independent values assumed; 1.96 of them are a 95 % confidence interval. Where the pictures
// are equal, or the squared errors smaller than such noise lets them be, it is not known.
#pragma once

#include "image/image.h"

struct estimate {
    double value;
    double error; // standard error; NaN: not known
};

struct metrics_input {
    const struct image *ref, *test;
    const struct image *ref_variance, *test_variance; // NULL: not known
    double eps;      // of relMSE, absolute; < 0: 1e-3 mean(ref)^2
    double exposure; // stops, for what is measured on the displayed picture
    int threads;     // 0: default
};

struct metrics {
    struct estimate mean_ratio; // mean(test) / mean(ref)
    struct estimate mse;        // mean((test - ref)^2)
    struct estimate relmse;     // mean((test - ref)^2 / (ref^2 + eps))
    // On the picture as `tonemap` shows it (exposure, clipped to [0,1], sRGB-encoded):
    struct estimate psnr;       // dB, peak 1
    struct estimate ssim;       // of luminance
    double mse_noise, relmse_noise; // what the known noise alone leads to expect; NaN: not known
    double eps;                 // that was used
    size_t left_out;            // non-finite values
};

// All but SSIM, which is left as NaN.
void metrics_measure(const struct metrics_input *in, struct metrics *out);

// Structural similarity, Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image Quality
// Assessment" (2004): Gaussian window 11x11 of sigma 1.5, K1 = 0.01, K2 = 0.03, range 1; mean over
// the windows that lie inside the picture (all of it, the window clipped, if it is smaller than
// 11). HDR: both luminances are shown first (exposure, clip, sRGB encoding).
double ssim_measure(const struct image *ref, const struct image *test, double exposure,
                    int threads);

// A value as displayed: exposed, clipped, sRGB-encoded.
float metrics_display(float v, float gain);
