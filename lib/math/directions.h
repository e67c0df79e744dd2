// SPDX-License-Identifier: Apache-2.0
// Functions on the sphere of directions: the cells of a latitude-longitude grid and real spherical
// harmonics.
#pragma once

#include <math.h>

// Cells of a picture of the whole sphere, w x h of equal angles: row 0 at +y, middle column at +z.
// The number of the cell that unit direction d lies in.
static inline unsigned latlong_cell(const float d[3], int w, int h) {
    const double turn = 0.5 + 0.5 * atan2((double)-d[0], (double)d[2]) / M_PI;
    const double y = d[1] > 1 ? 1 : d[1] < -1 ? -1 : (double)d[1];
    const int column = (int)(turn * w), row = (int)(acos(y) / M_PI * h);
    return (unsigned)((row < h ? row : h - 1) * w + (column < w ? column : w - 1));
}

// The direction at place (x, y) of that picture, in cells.
static inline void latlong_direction(double x, double y, int w, int h, double d[3]) {
    const double phi = (x / w - 0.5) * 2 * M_PI, theta = y / h * M_PI;
    d[0] = -sin(phi) * sin(theta);
    d[1] = cos(theta);
    d[2] = cos(phi) * sin(theta);
}

// Solid angle of a cell of row y.
static inline double latlong_solid_angle(int y, int w, int h) {
    return 2 * M_PI / w * (cos(M_PI * y / h) - cos(M_PI * (y + 1) / h));
}

// Real spherical harmonics of unit direction d up to `order`: out[l * (l + 1) + m], (order + 1)^2
// values. Orthonormal, without the phase (-1)^m; Y_1-1, Y_10, Y_11 are proportional to y, z, x.
static inline void spherical_harmonics(const double d[3], int order, double *out) {
    // c + i s = (x + i y)^m; p: associated Legendre functions without their factor sin^m, by
    // upward recurrence in l (Press et al. 2007, 6.7).
    double c = 1, s = 0, p_mm = 1;
    for (int m = 0; m <= order; m++) {
        double p1 = p_mm, p0 = 0;
        for (int l = m; l <= order; l++) {
            double k = (2 * l + 1) / (4 * M_PI);
            for (int i = l - m + 1; i <= l + m; i++)
                k /= i;
            k = sqrt(k);
            out[l * (l + 1) + m] = m ? sqrt(2) * k * p1 * c : k * p1;
            if (m)
                out[l * (l + 1) - m] = sqrt(2) * k * p1 * s;
            const double p2 = ((2 * l + 1) * d[2] * p1 - (l + m) * p0) / (l - m + 1);
            p0 = p1;
            p1 = p2;
        }
        p_mm *= 2 * m + 1;
        const double turned = c * d[0] - s * d[1];
        s = c * d[1] + s * d[0];
        c = turned;
    }
}
