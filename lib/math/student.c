// SPDX-License-Identifier: Apache-2.0
#include "math/student.h"

#include <math.h>

double student_95(int degrees) {
    static const double exact[] = {INFINITY, 12.7062, 4.3027, 3.1824, 2.7764, 2.5706};
    if (degrees <= 5)
        return exact[degrees < 0 ? 0 : degrees];
    // Cornish-Fisher expansion in 1 / degrees (Abramowitz and Stegun 1964, 26.7.5).
    const double z = 1.959964, n = degrees;
    return z + (z * z * z + z) / (4 * n) +
           (5 * pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * n * n) +
           (3 * pow(z, 7) + 19 * pow(z, 5) + 17 * z * z * z - 15 * z) / (384 * n * n * n);
}

// The incomplete beta function's continued fraction, by Lentz's method (Press et al. 2007, Numerical
// Recipes, 6.4); converges for x < (a + 1) / (a + b + 2).
static double beta_fraction(double a, double b, double x) {
    double c = 1, d = 1 / (1 - (a + b) * x / (a + 1)), h = d;
    for (int m = 1; m < 500; m++) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / (1 + even * d);
        c = 1 + even / c;
        h *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / (1 + odd * d);
        c = 1 + odd / c;
        h *= d * c;
        if (fabs(d * c - 1) < 1e-14)
            break;
    }
    return h;
}

// I_x(n/2, 1/2) with x = n / (n + t^2) (Abramowitz and Stegun 1964, 26.7.1).
double student_p_value(double t, double degrees) {
    const double a = 0.5 * degrees, b = 0.5, t2 = t * t;
    if (isinf(degrees) || degrees > 1e7)
        return erfc(fabs(t) * 0.70710678118654752440);
    if (t2 == 0 || isinf(t2))
        return t2 == 0;
    const double x = degrees / (degrees + t2), y = t2 / (degrees + t2);
    const double front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log(y));
    return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a
                                     : 1 - front * beta_fraction(b, a, y) / b;
}
