// SPDX-License-Identifier: Apache-2.0
#include "image/flip_kernel.h"

#include <math.h>

#define PI 3.14159265358979323846

// Weights a * exp(-pi^2 x^2 / b), x in degrees. The factor of the 2-D filter, sqrt(pi / b) times
// the paper's amplitude, is split evenly over the two passes.
static double make_gaussian(struct flip_kernel *k, int radius, double amplitude, double b,
                            double ppd) {
    const double a = sqrt(amplitude * sqrt(PI / b));
    double sum = 0;
    k->radius = radius;
    for (int i = -radius; i <= radius; i++) {
        const double x = i / ppd;
        k->weight[i + radius] = (float)(a * exp(-PI * PI * x * x / b));
        sum += k->weight[i + radius];
    }
    return sum;
}

static void scale(struct flip_kernel *k, double factor) {
    for (int i = 0; i <= 2 * k->radius; i++)
        k->weight[i] = (float)(k->weight[i] * factor);
}

// Positive weights then add up to 1, negative ones to -1.
static void balance(struct flip_kernel *k) {
    double positive = 0, negative = 0;
    for (int i = 0; i <= 2 * k->radius; i++)
        *(k->weight[i] > 0 ? &positive : &negative) += k->weight[i];
    for (int i = 0; i <= 2 * k->radius; i++) {
        const double by = k->weight[i] > 0 ? positive : -negative;
        k->weight[i] = by > 0 ? (float)(k->weight[i] / by) : 0;
    }
}

static int clip_radius(double r) {
    return r < FLIP_MOST_RADIUS ? (int)ceil(r) : FLIP_MOST_RADIUS;
}

static void make_features(struct flip_kernels *k, double ppd) {
    const double sigma = 0.5 * 0.082 * ppd; // half the width of a detectable feature, 0.082 degrees
    const int radius = clip_radius(3 * sigma);
    double sum = 0;
    k->gauss.radius = k->edge.radius = k->point.radius = radius;
    for (int i = -radius; i <= radius; i++) {
        const double g = exp(-i * i / (2 * sigma * sigma));
        k->gauss.weight[i + radius] = (float)g;
        k->edge.weight[i + radius] = (float)(-i * g);
        k->point.weight[i + radius] = (float)((i * i / (sigma * sigma) - 1) * g);
        sum += g;
    }
    scale(&k->gauss, 1 / sum);
    balance(&k->edge);
    balance(&k->point);
}

void flip_make_kernels(struct flip_kernels *k, double pixels_per_degree) {
    const double ppd = pixels_per_degree < 3700 ? pixels_per_degree : 3700;
    // The widest Gaussian decides the radius of all of them: b = 0.04.
    const int radius = clip_radius(3 * sqrt(0.04 / (2 * PI * PI)) * ppd);
    scale(&k->csf_y, 1 / make_gaussian(&k->csf_y, radius, 1, 0.0047, ppd));
    scale(&k->csf_cx, 1 / make_gaussian(&k->csf_cx, radius, 1, 0.0053, ppd));
    const double s1 = make_gaussian(&k->csf_cz1, radius, 34.1, 0.04, ppd);
    const double s2 = make_gaussian(&k->csf_cz2, radius, 13.5, 0.025, ppd);
    scale(&k->csf_cz1, 1 / sqrt(s1 * s1 + s2 * s2));
    scale(&k->csf_cz2, 1 / sqrt(s1 * s1 + s2 * s2));
    make_features(k, ppd);
}
