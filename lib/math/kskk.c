// SPDX-License-Identifier: Apache-2.0
#include "math/kskk.h"

#include "math/quadrature.h"

// A direction wo and one azimuth phi of half vectors h = (mx r cos(phi), my r sin(phi), 1) / norm:
//
//     norm^2 = 1 + b r^2,  wo.h = (cos_o + a r) / norm,
//     cos_i = (2 a r + cos_o (1 - b r^2)) / norm^2
//
// r has the density 2 r exp(-r^2); light comes from above for r up to the root of cos_i.
struct ray_of_slopes {
    double cos_o, a, b;
};

// f cos_i / pdf, times cos_o^alpha
static double scaled_weight(const struct kskk *k, const struct ray_of_slopes *s, double r) {
    const double norm2 = 1 + s->b * r * r, norm = sqrt(norm2);
    const double cos_i = (2 * s->a * r + s->cos_o * (1 - s->b * r * r)) / norm2;
    const double F = schlick_fresnel(fmin((s->cos_o + s->a * r) / norm, 1), k->r0);
    return cos_i > 0 ? (k->transmits ? 1 - F : F) * pow(cos_i, 1 - k->alpha) * norm : 0;
}

enum { RADII = 48, AZIMUTHS = 24 };

// Over r, with nodes that gather where cos_i vanishes: r = end (1 - (1 - x)^2).
static double integrate_radii(const struct kskk *k, const struct ray_of_slopes *s, const double *x,
                              const double *w) {
    const double root = sqrt(s->a * s->a + s->b * s->cos_o * s->cos_o);
    const double last = s->a < 0 ? s->cos_o / (root - s->a) : (s->a + root) / (s->b * s->cos_o);
    const double end = fmin(last, 6); // exp(-36) is nothing
    double sum = 0;
    for (int i = 0; i < RADII; i++) {
        const double r = end * x[i] * (2 - x[i]), dr = end * 2 * (1 - x[i]);
        sum += w[i] * dr * 2 * r * exp(-r * r) * scaled_weight(k, s, r);
    }
    return sum;
}

double kskk_albedo(const struct kskk *k, double cos_o, double phi_o) {
    double x[RADII], w[RADII], y[AZIMUTHS], v[AZIMUTHS], sum = 0;
    gauss_legendre(RADII, x, w);
    gauss_legendre(AZIMUTHS, y, v);
    const double sine = sqrt(fmax((1 - cos_o) * (1 + cos_o), 0));
    const double along = sine * cos(phi_o) * k->slopes.mx;
    const double across = sine * sin(phi_o) * k->slopes.my;
    // a is greatest in the middle and vanishes a quarter turn off, where nodes gather
    const double middle = atan2(across, along);
    for (int quarter = 0; quarter < 4; quarter++) {
        for (int i = 0; i < AZIMUTHS; i++) {
            const double turn = (quarter & 1 ? 1 : -1) + (quarter & 2 ? 1 : -1) * y[i] * y[i];
            const double phi = middle + 0.5 * M_PI * turn;
            const double c = cos(phi), s = sin(phi), mx = k->slopes.mx, my = k->slopes.my;
            const struct ray_of_slopes ray = {cos_o, along * c + across * s,
                                              mx * mx * c * c + my * my * s * s};
            sum += 0.5 * v[i] * y[i] * integrate_radii(k, &ray, x, w);
        }
    }
    return sum / pow(cos_o, k->alpha);
}
