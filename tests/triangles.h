// SPDX-License-Identifier: Apache-2.0
// Spherical triangles by chance, the same at every run; for tests of their shares.
#pragma once

#include <math.h>
#include <stdint.h>

static uint64_t state = 1; // a test may begin elsewhere

static inline double uniform(void) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

static inline void unit(double w[3]) {
    const double z = 2 * uniform() - 1, r = sqrt(1 - z * z), phi = 2 * M_PI * uniform();
    w[0] = r * cos(phi);
    w[1] = r * sin(phi);
    w[2] = z;
}

static inline void normalise(double w[3]) {
    const double l = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    for (int i = 0; i < 3; i++)
        w[i] /= l;
}

// Directions about a middle one, `size` radians away.
static inline void make_triangle(const double middle[3], double size, double corner[3][3]) {
    for (int i = 0; i < 3; i++) {
        double d[3];
        unit(d);
        for (int k = 0; k < 3; k++)
            corner[i][k] = middle[k] + size * d[k];
        normalise(corner[i]);
    }
}
