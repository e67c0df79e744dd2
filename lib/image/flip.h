// SPDX-License-Identifier: Apache-2.0
// FLIP: the difference a person sees when flipping between two pictures.
//
// P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. D. Fairchild, "FLIP: A
// Difference Evaluator for Alternating Images" (2020); the same for HDR in "Visualizing Errors in
// Rendered High Dynamic Range Images" (2021). Values 0 (no difference) to 1. Constants and edge
// handling follow the authors' flip-evaluator, with which the means agree to 1e-4.
//
// Pictures: linear Rec.709 in 3 channels, of equal size. NaN counts as 0, negative values as 0.
#pragma once

#include "image/image.h"

// 0.7 m before a monitor 0.7 m wide with 3840 pixels.
#define FLIP_PIXELS_PER_DEGREE 67.0206432765823

// Display-referred pictures: values beyond [0,1] are clipped. Returns the mean; *map (may be NULL)
// becomes a picture of one channel, owned by the caller. threads 0: default.
double flip_ldr(const struct image *ref, const struct image *test, double pixels_per_degree,
                int threads, struct image *map);

struct flip_exposures {
    double start, stop; // stops
    int count;
};

// The exposures HDR-FLIP looks at: from the one where the reference's maximum is just not burnt
// out to the one where its median is (ACES tone curve, 2021 paper section 4).
struct flip_exposures flip_find_exposures(const struct image *ref);
// The largest LDR-FLIP over these exposures in each pixel, after the ACES tone curve.
double flip_hdr(const struct image *ref, const struct image *test,
                const struct flip_exposures *exposures, double pixels_per_degree, int threads,
                struct image *map);

// Colour of a value 0..1 in the magma map, sRGB-encoded 0..1.
void flip_magma(float v, float rgb[3]);
