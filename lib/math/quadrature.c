// SPDX-License-Identifier: Apache-2.0
#include "math/quadrature.h"

#include <math.h>

// Legendre polynomial of degree n at x, and its derivative, by the three-term recurrence.
static double legendre(int n, double x, double *derivative) {
    double p0 = 1, p1 = x;
    for (int k = 2; k <= n; k++) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
    }
    *derivative = n * (x * p1 - p0) / (x * x - 1);
    return p1;
}

void gauss_legendre(int n, double *nodes, double *weights) {
    for (int i = 0; i < (n + 1) / 2; i++) {
        double x = n == 1 ? 0 : cos(3.14159265358979323846 * (i + 0.75) / (n + 0.5));
        double d = 1;
        for (int step = 0; step < 20 && n > 1; step++) { // Newton; converges in about 4 steps
            const double dx = legendre(n, x, &d) / d;
            x -= dx;
            if (fabs(dx) < 1e-15)
                break;
        }
        if (n > 1)
            legendre(n, x, &d);
        const double w = n == 1 ? 2 : 2 / ((1 - x * x) * d * d);
        nodes[i] = 0.5 * (1 - x);
        nodes[n - 1 - i] = 0.5 * (1 + x);
        weights[i] = weights[n - 1 - i] = 0.5 * w;
    }
}
