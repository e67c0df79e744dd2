// SPDX-License-Identifier: Apache-2.0
#include "math/fresnel.h"

#include "math/quadrature.h"

static double dielectric(double c, double eta) {
    const double d = (eta - 1) * (eta + 1), q = sqrt(c * c + d), e2 = eta * eta;
    const double r_s = d / ((c + q) * (c + q));
    const double r_p = d * (1 - c * c * (1 + e2)) / ((q + e2 * c) * (q + e2 * c));
    return 0.5 * (r_s * r_s + r_p * r_p);
}

double fresnel_dielectric_average(double eta) {
    if (eta == 1)
        return 0;
    if (eta < 1)
        return 1 - fresnel_dielectric_transmitted(eta);
    // F falls off within sqrt(eta^2 - 1) of grazing: c = t^3 puts nodes there.
    enum { N = 96 };
    double t[N], w[N], sum = 0;
    gauss_legendre(N, t, w);
    for (int i = 0; i < N; i++) {
        const double c = t[i] * t[i] * t[i];
        sum += w[i] * 3 * t[i] * t[i] * 2 * c * dielectric(c, eta);
    }
    return sum;
}

// Both sides of an interface exchange the same power: (1 - F(1/n)) n^2 = 1 - F(n).
double fresnel_dielectric_transmitted(double eta) {
    if (eta < 1)
        return eta * eta * fresnel_dielectric_transmitted(1 / eta);
    return 1 - fresnel_dielectric_average(eta);
}
