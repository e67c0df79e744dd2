// SPDX-License-Identifier: Apache-2.0
// The energy-preserving Oren-Nayar model (Portsmouth, Kutz and Hill 2024, EON: A Practical
// Energy-Preserving Rough Diffuse BRDF). Its single scattering is Fujii's improvement of
// Oren-Nayar's qualitative model; multiple scattering restores what that loses, so that a
// reflectance of 1 reflects everything.
//
// Roughness r in [0, 1]; mu are cosines with n. f is given times pi.
#pragma once

#include "math/direction.h"

// Fujii's A, eq. 7 there.
static inline double fujii_A(double r) {
    return 1 / (1 + (0.5 - 2 / (3 * M_PI)) * r);
}

// Single scattering, f pi / rho.
static inline double fujii_brdf(struct direction wo, struct direction wi, double r) {
    const double s = wo.x * wi.x + wo.y * wi.y;
    return fujii_A(r) * (1 + r * (s > 0 ? s / fmax(wo.z, wi.z) : s));
}

// Directional albedo of single scattering for rho = 1, exact. In theta = acos(mu), with the
// fraction (1 - sin^3) / mu free of cancellation.
static inline double fujii_albedo(double mu, double r) {
    const double s = sqrt(fmax((1 - mu) * (1 + mu), 0));
    const double q = mu * (1 + s + s * s) / (1 + s); // (1 - s^3) / mu
    const double G = s * (acos(fmin(mu, 1)) - s * mu) + 2.0 / 3 * (s * q - s);
    return fujii_A(r) * (1 + r * G / M_PI);
}

// Its mean over the hemisphere, 2 times the integral of mu times it.
static inline double fujii_average(double r) {
    return fujii_A(r) * (1 + (2.0 / 3 - 28 / (15 * M_PI)) * r);
}

// Multiple scattering for rho = 1, f pi: to be multiplied by eon_multiple_reflectance.
static inline double eon_multiple(double mu_o, double mu_i, double r) {
    const double lost = 1 - fujii_average(r);
    return lost > 0 ? fmax(1 - fujii_albedo(mu_o, r), 0) * fmax(1 - fujii_albedo(mu_i, r), 0) / lost
                    : 0;
}

static inline double eon_multiple_reflectance(double rho, double r) {
    const double E = fujii_average(r);
    return rho * rho * E / (1 - rho * (1 - E));
}

// A clipped, linearly transformed cosine lobe fits f cos_i (section 4 there); a share of uniform
// directions bounds the weight.
struct eon_lobe {
    struct direction x; // azimuth of wo: its z is 0
    double a, b, c, d;  // the transform: (x, y, z) to (a x + b z, c y, d x + z)
    double clip;        // (1 + v_z) / 2: share of the cosine lobe that ends above the surface
    double p_uniform;
};

static inline struct eon_lobe eon_lobe_make(struct direction wo, double r) {
    const double mu = wo.z, sine = sqrt(wo.x * wo.x + wo.y * wo.y);
    struct eon_lobe l;
    l.x = sine > 0 ? (struct direction){wo.x / sine, wo.y / sine, 0} : (struct direction){1, 0, 0};
    l.a = 1 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r);
    l.b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) /
          (mu * mu * mu - 1.43545);
    l.c = 1 + r * (0.20013 + (-0.506373 + 0.261777 * mu) * mu);
    l.d = r * (0.540852 + (-1.01625 + 0.475392 * mu) * mu) / (-1.0743 + (0.0725628 + mu) * mu);
    l.clip = 0.5 * (1 + 1 / sqrt(l.d * l.d + 1));
    l.p_uniform =
        pow(r, 0.1) * (0.162925 + (-0.372058 + (0.538233 - 0.290822 * mu) * mu) * mu);
    return l;
}

static inline double eon_lobe_pdf(const struct eon_lobe *l, struct direction wi) {
    // wi in the frame of wo, then through the inverse transform
    const double x = wi.x * l->x.x + wi.y * l->x.y, y = wi.y * l->x.x - wi.x * l->x.y, z = wi.z;
    const double det = l->a - l->b * l->d;
    const double hx = (x - l->b * z) / det, hy = y / l->c, hz = (l->a * z - l->d * x) / det;
    const double h2 = hx * hx + hy * hy + hz * hz;
    const double lobe = fmax(hz, 0) / (h2 * h2 * fabs(l->c * det) * M_PI * l->clip);
    return l->p_uniform / (2 * M_PI) + (1 - l->p_uniform) * lobe;
}

// u1 chooses between the two; u, v choose the direction; all in [0, 1).
static inline struct direction eon_lobe_sample(const struct eon_lobe *l, double u1, double u,
                                               double v) {
    const double phi = 2 * M_PI * v;
    if (u1 < l->p_uniform) {
        const double z = 1 - u, s = sqrt((1 - z) * (1 + z));
        return (struct direction){s * cos(phi), s * sin(phi), z};
    }
    // the part of the disk under the lobe that the transform leaves above the surface
    const double y = sqrt(u) * sin(phi);
    const double edge = -sqrt(fmax(1 - y * y, 0));
    const double x = edge * (1 - l->clip) - sqrt(u) * cos(phi) * l->clip;
    const double z = sqrt(fmax(1 - x * x - y * y, 0));
    const struct direction w = direction_of(l->a * x + l->b * z, l->c * y, l->d * x + z);
    return (struct direction){w.x * l->x.x - w.y * l->x.y, w.x * l->x.y + w.y * l->x.x, w.z};
}
