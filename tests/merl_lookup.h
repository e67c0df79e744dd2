// SPDX-License-Identifier: Apache-2.0
// A MERL table looked up in double precision, written from the definition and apart from
// table/merl.c, for brute-force integrals.
#pragma once

#include <math.h>

#include "table/merl.h"

static inline double lookup_cell(const float (*rgb)[3], int i, int j, int k, int c) {
    i = i < MERL_THETA_H ? i : MERL_THETA_H - 1;
    j = j < MERL_THETA_D ? j : MERL_THETA_D - 1;
    return (double)rgb[((size_t)i * 90 + (size_t)j) * 180 + (size_t)(k % 180)][c];
}

// wi and wo unit, above the surface.
static inline void lookup_merl(const float (*rgb)[3], const double wi[3], const double wo[3],
                               double f[3]) {
    double h[3], l = 0;
    for (int a = 0; a < 3; a++)
        h[a] = wi[a] + wo[a], l += h[a] * h[a];
    for (int a = 0; a < 3; a++)
        h[a] /= sqrt(l);
    const double theta = acos(fmin(h[2], 1)), phi = atan2(h[1], h[0]);
    // wi turned by -phi about the normal, then by -theta about the bitangent
    const double x = cos(phi) * wi[0] + sin(phi) * wi[1], y = cos(phi) * wi[1] - sin(phi) * wi[0];
    const double d[3] = {cos(theta) * x - sin(theta) * wi[2], y,
                         sin(theta) * x + cos(theta) * wi[2]};
    double turn = atan2(d[1], d[0]);
    turn = turn < 0 ? turn + M_PI : turn;
    const double p[3] = {fmin(sqrt(theta / (M_PI / 2)) * 90, 89),
                         fmin(acos(fmin(d[2], 1)) * 180 / M_PI, 89), fmin(turn * 180 / M_PI, 180)};
    const int i = (int)p[0], j = (int)p[1], k = (int)p[2];
    for (int c = 0; c < 3; c++) {
        f[c] = 0;
        for (int corner = 0; corner < 8; corner++) {
            const int a = corner >> 2, b = corner >> 1 & 1, e = corner & 1;
            const double w = (a ? p[0] - i : 1 - p[0] + i) * (b ? p[1] - j : 1 - p[1] + j) *
                             (e ? p[2] - k : 1 - p[2] + k);
            f[c] += w > 0 ? w * lookup_cell(rgb, i + a, j + b, k + e, c) : 0;
        }
    }
}
