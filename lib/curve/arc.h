// SPDX-License-Identifier: Apache-2.0
// The arc tangent in double precision, inline: the library's takes longer than all else that a
// curve's angle needs. Coefficients of Cephes (Moshier 1989), right to 2 units in the last place.
#pragma once

// atan t, |t| <= 0.66, z = t t; of any type that has these operators.
#define ARC_TANGENT(t, z)                                                                          \
    ((t) * ((z) *                                                                                  \
            (((((-8.750608600031904122785e-1 * (z) - 1.615753718733365076637e1) * (z) -            \
                7.500855792314704667340e1) * (z) - 1.228866684490136173410e2) * (z) -              \
              6.485021904942025371773e1)) /                                                        \
            ((((((z) + 2.485846490142306297962e1) * (z) + 1.650270098316988542046e2) * (z) +       \
               4.328810604912902668951e2) * (z) + 4.853903996359136964868e2) * (z) +               \
             1.945506571482613964425e2)) + (t))

// Angle of (x, y) from the x axis, x and y at least 0; 0 of (0, 0).
static inline double arc_quarter(double y, double x) {
    const double quarter = 0.78539816339744830962, more = 6.123233995736765886130e-17; // pi/2 - its double
    const double low = y < x ? y : x, high = y < x ? x : y;
    const int far = low > 0.66 * high;
    const double t = high > 0 ? (far ? (low - high) / (low + high) : low / high) : 0, z = t * t;
    const double a = ARC_TANGENT(t, z);
    const double angle = far ? quarter + (a + 0.5 * more) : a;
    return y <= x ? angle : 2 * quarter - (angle - more);
}
