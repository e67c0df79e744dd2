// SPDX-License-Identifier: Apache-2.0
// Denoising by Intel's Open Image Denoise, where that is installed (version 1 or 2; it is looked for
// when it is asked for, and nothing else needs it).
//
// What comes out is no longer an unbiased picture: it is labelled by the attribute relume.denoised,
// and its layer of variances, which would be untrue, is dropped.
#pragma once

#include "image/image.h"

struct denoise_options {
    bool colour_only; // leave albedo.* and N.* aside where the picture has them
    int threads;      // 0: default
};

// Denoises channels R G B in place. Values that are not finite become 0 before, which is warned
// about. false after an error message that says what to install.
bool denoise(struct image *im, const struct denoise_options *options);
