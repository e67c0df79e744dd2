// SPDX-License-Identifier: Apache-2.0
// Microfacet surfaces: distributions of normals, their masking, and sampling of visible normals.
//
// Conventions: local frame with n = +z, all directions on its upper side. Roughness alpha_u along
// x, alpha_v along y (Beckmann: root mean square slope times sqrt 2; both as in Mitsuba). Smith
// masking, separable for two directions, G = G1(wo) G1(wi), as in Mitsuba 3; the height-correlated
// form is not used.
//
// Everything is written with sigma(v), the projected area of the facets that v sees per unit of
// macrosurface (Heitz 2014, Understanding the Masking-Shadowing Function, eq. 15 and 16):
//
//     sigma(v) = cos_v / G1(v) = integral of D(m) <v, m> dm       never 0, even at grazing
//     D_v(m)   = <v, m> D(m) / sigma(v)                           density of visible normals
//     reflection at half vector h: f |cos_i| = F D(h) cos_i / (4 sigma_o sigma_i),
//                                  pdf_sa    = D(h) / (4 sigma_o)
#pragma once

#include "math/elementary.h"
#include "math/vec.h"

enum microfacet_type { MICROFACET_BECKMANN, MICROFACET_GGX };

// Below this a rough surface is the smooth one.
#define MICROFACET_ALPHA_MIN 1e-4f

struct microfacet {
    enum microfacet_type type;
    float alpha_u, alpha_v;
    float inv_u, inv_v; // 1 / alpha
    float norm;         // 1 / (pi alpha_u alpha_v)
};

// Roughness is clamped to [MICROFACET_ALPHA_MIN, 1e3].
static inline struct microfacet microfacet_make(enum microfacet_type type, float alpha_u,
                                                float alpha_v) {
    struct microfacet m = {.type = type};
    m.alpha_u = clampf(alpha_u, MICROFACET_ALPHA_MIN, 1e3f);
    m.alpha_v = clampf(alpha_v, MICROFACET_ALPHA_MIN, 1e3f);
    m.inv_u = 1 / m.alpha_u;
    m.inv_v = 1 / m.alpha_v;
    m.norm = INV_PI * m.inv_u * m.inv_v;
    return m;
}

// D(h): area of facets with normal h, per solid angle and unit of macrosurface. 0 for h below.
static inline float microfacet_D(const struct microfacet *m, vec3 h) {
    const float z2 = h[2] * h[2];
    if (!(h[2] > 1e-6f))
        return 0;
    const float x = h[0] * m->inv_u, y = h[1] * m->inv_v;
    const float r2 = x * x + y * y;
    if (m->type == MICROFACET_GGX)
        return m->norm / sqr(r2 + z2);
    return m->norm * fast_exp(-r2 / z2) / (z2 * z2);
}

// t^2 = (alpha_u v_x)^2 + (alpha_v v_y)^2: squared length of v's tangential part after stretching
static inline float microfacet_stretch2(const struct microfacet *m, vec3 v) {
    return sqr(m->alpha_u * v[0]) + sqr(m->alpha_v * v[1]);
}

// exp(-a^2) / (a-independent form of) erfc for a >= 0, given e = exp(-a^2): absolute error 1.5e-7
// (Abramowitz and Stegun 1964, 7.1.26).
static inline float erfc_given_exp(float a, float e) {
    const float t = 1 / (1 + 0.3275911f * a);
    return t * (0.254829592f +
                t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f)))) *
           e;
}

// sigma(v) for v_z >= 0; in (0, 1] up to rounding.
static inline float microfacet_area(const struct microfacet *m, vec3 v) {
    const float z = maxf(v[2], 0), t2 = microfacet_stretch2(m, v);
    if (m->type == MICROFACET_GGX)
        return maxf(0.5f * (z + sqrtf(z * z + t2)), 1e-20f);
    // z (1 + Lambda), Lambda = (exp(-a^2) / (a sqrt pi) - erfc(a)) / 2 with a = z / t
    if (z * z >= 16 * t2)
        return maxf(z, 1e-20f);
    const float t = sqrtf(t2), a = z / t, e = fast_exp(-a * a);
    return z + 0.5f * (t * 0.56418958f * e - z * erfc_given_exp(a, e));
}

// Smith's masking, the share of the facets facing v that v sees.
static inline float microfacet_G1(const struct microfacet *m, vec3 v) {
    return minf(maxf(v[2], 0) / microfacet_area(m, v), 1);
}

// A normal with the density D_v of visible normals, for v_z > 0 and u in [0,1)^2.
vec3 microfacet_sample(const struct microfacet *m, vec3 v, struct vec2 u);

// The inverse of erf on (-1, 1): relative error 3.5e-7 (Giles 2012, Approximating the erfinv
// function, table 5). Arguments of +-1 give about +-4.
float erf_inverse(float x);
// Its coefficients: in w - 2.5 and, from w = 5 on, in sqrt(w) - 3, of w = -log(1 - x^2).
extern const float erf_inverse_middle[9], erf_inverse_tail[9];

// What a rough dielectric boundary reflects and transmits of light from v, single scattering, by
// quadrature over visible normals with n x n nodes: the two sum to less than 1 where facets shadow
// each other. eta as in math/fresnel.h.
void microfacet_albedo_from(const struct microfacet *m, float eta, vec3 v, int n,
                            double *reflected, double *transmitted);
// The same from direction cosine mu, for isotropic facets.
void microfacet_albedo(const struct microfacet *m, float eta, float mu, int n, double *reflected,
                       double *transmitted);
// What facets that reflect everything return of light from v without a second reflection.
double microfacet_albedo_mirror(const struct microfacet *m, vec3 v, int n);
