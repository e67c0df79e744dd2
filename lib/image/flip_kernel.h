// SPDX-License-Identifier: Apache-2.0
// The one-dimensional kernels of FLIP. All its 2-D filters are products of these.
#pragma once

enum { FLIP_MOST_RADIUS = 512 };

struct flip_kernel {
    int radius;
    float weight[2 * FLIP_MOST_RADIUS + 1];
};

struct flip_kernels {
    // Contrast sensitivity (2020 paper, section 4.1.1): Y, Cx, and Cz as a sum of two Gaussians.
    struct flip_kernel csf_y, csf_cx, csf_cz1, csf_cz2;
    // Feature detectors (section 4.2.1): Gaussian, its first and second derivative.
    struct flip_kernel gauss, edge, point;
};

// Pixels per degree is clipped to what FLIP_MOST_RADIUS allows (above 3700).
void flip_make_kernels(struct flip_kernels *k, double pixels_per_degree);
