// SPDX-License-Identifier: Apache-2.0
// The metrics of perceived difference, which no formula gives the noise of: SSIM and FLIP. Their
// standard errors come from a parametric bootstrap: the spread over 8 pairs of pictures to which
// Gaussian noise of the known variance is added once more.
#pragma once

#include "image/flip.h"
#include "image/metrics.h"

struct perceived {
    double ssim, flip_ldr, flip_hdr;
};

// *exposures and *map (may be NULL) are outputs: HDR-FLIP's range, from the reference, and map.
struct perceived perceived_measure(const struct metrics_input *in, double pixels_per_degree,
                                   struct flip_exposures *exposures, struct image *map);
// Standard errors; NaN where neither variance is known.
struct perceived perceived_errors(const struct metrics_input *in, double pixels_per_degree,
                                  const struct flip_exposures *exposures);
