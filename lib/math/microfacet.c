// SPDX-License-Identifier: Apache-2.0
#include "math/microfacet.h"

#include <assert.h>

#include "math/elementary.h"
#include "math/fresnel.h"
#include "math/quadrature.h"

const float erf_inverse_middle[9] = {
    1.50140941f,     0.246640727f,     -0.00417768164f, -0.00125372503f, 0.00021858087f,
    -4.39150654e-06f, -3.5233877e-06f, 3.43273939e-07f, 2.81022636e-08f};
const float erf_inverse_tail[9] = {
    2.83297682f,     1.00167406f,    0.00943887047f,  -0.0076224613f, 0.00573950773f,
    -0.00367342844f, 0.00134934322f, 0.000100950558f, -0.000200214257f};

// c[0] + c[1] w + ... + c[8] w^8 by Estrin's scheme
static float polynomial8(const float c[9], float w) {
    const float w2 = w * w, w4 = w2 * w2;
    return ((c[0] + c[1] * w) + (c[2] + c[3] * w) * w2) +
           ((c[4] + c[5] * w) + (c[6] + c[7] * w) * w2) * w4 + c[8] * (w4 * w4);
}

float erf_inverse(float x) {
    const float w = -fast_log(fmaxf((1 - x) * (1 + x), 1.2e-7f));
    if (w < 5)
        return polynomial8(erf_inverse_middle, w - 2.5f) * x;
    return polynomial8(erf_inverse_tail, sqrtf(w) - 3) * x;
}

// The hemisphere of GGX facets is the upper half of an ellipsoid; stretched to a sphere, what v
// sees of it is a spherical cap reflected at v (Heitz 2018, Sampling the GGX Distribution of
// Visible Normals; in the form of Dupuy and Benyoub 2023, Sampling Visible GGX Normals with
// Spherical Caps). h_z = c_z + v_z is formed without cancellation.
static vec3 sample_ggx(const struct microfacet *m, vec3 v, struct vec2 u) {
    const vec3 s = normalize(v3(m->alpha_u * v[0], m->alpha_v * v[1], v[2]));
    const float hz = (1 - u.y) * (1 + s[2]), cz = hz - s[2];
    const float r = safe_sqrt((1 - cz) * (1 + cz));
    float sine, cosine;
    sincos_turn(u.x, &sine, &cosine);
    const float hx = r * cosine + s[0], hy = r * sine + s[1];
    return normalize(v3(m->alpha_u * hx, m->alpha_v * hy, maxf(hz, 1e-20f)));
}

// Slope along v of a visible facet of the Beckmann surface with alpha = 1, where v has cotangent
// c > 0 with the normal. With s = erf^-1(x) and e = exp(-s^2), the distribution function is
// g(x) / g(erf c),
//
//     g(x) = c (1 + x) + e / sqrt(pi),    g'(x) = c - s,    g''(x) = -s'(x) = -sqrt(pi) / (2 e)
//
// found by Halley's method inside a bracket (Newton's: Jakob 2014, An Improved Visible Normal
// Sampling Routine for the Beckmann Distribution; there divided by c, which overflows). The start
// mixes the solutions for grazing v (c = 0) and for v at the normal; with it one step nearly always
// suffices. The last step is taken in s: with ds = s' dx,
//
//     s(x + dx) = s + ds / (1 - s ds - (1 + s^2) ds^2 / 3) + O(ds^4)
//
// In all, the distribution function is met to 5e-5.
static float sample_beckmann_slope(float c, float u) {
    const float inv_sqrt_pi = 0.56418958f, half_sqrt_pi = 0.88622693f;
    u = clampf(u, 1e-7f, 1 - 1e-7f);
    if (c > 1e4f)
        return erf_inverse(2 * u - 1);
    const float e_end = fast_exp(-c * c), end = 1 - erfc_given_exp(c, e_end);
    const float total = c * (1 + end) + inv_sqrt_pi * e_end;
    float lo = -1, hi = end, s = 0;
    const float grazing = end - (end + 1) * (1 - erfc_given_exp(sqrtf(-fast_log(u)), u));
    float x = lerpf(1 / (1 + 0.3f * c * c), (1 + end) * u - 1, grazing);
    for (int i = 0; i < 12; i++) {
        x = x > lo && x < hi ? x : 0.5f * (lo + hi);
        s = erf_inverse(x);
        const float e = fast_exp(-s * s), slope = half_sqrt_pi / e;
        const float g = c * (1 + x) + inv_sqrt_pi * e - u * total, g1 = c - s;
        if (g > 0)
            hi = x;
        else
            lo = x;
        const float dx = -2 * g * g1 / (2 * g1 * g1 + g * slope), ds = dx * slope;
        if (fabsf(ds) * (1 + 0.5f * s * s) < 0.1f) {
            s += ds / (1 - ds * (s + ds * (1 + s * s) * (1.0f / 3)));
            break;
        }
        x += dx;
    }
    return fminf(s, c);
}

static vec3 sample_beckmann(const struct microfacet *m, vec3 v, struct vec2 u) {
    const float t = sqrtf(microfacet_stretch2(m, v));
    const float c = v[2] / maxf(t, 1e-30f);
    const float along = sample_beckmann_slope(c, u.x);
    const float across = erf_inverse(2 * clampf(u.y, 3e-8f, 1 - 6e-8f) - 1);
    const float inv = t > 0 ? 1 / t : 0;
    const float cos_phi = t > 0 ? m->alpha_u * v[0] * inv : 1;
    const float sin_phi = m->alpha_v * v[1] * inv;
    const float x = cos_phi * along - sin_phi * across;
    const float y = sin_phi * along + cos_phi * across;
    return normalize(v3(-m->alpha_u * x, -m->alpha_v * y, 1));
}

vec3 microfacet_sample(const struct microfacet *m, vec3 v, struct vec2 u) {
    return m->type == MICROFACET_GGX ? sample_ggx(m, v, u) : sample_beckmann(m, v, u);
}

// Shares of the light that arrives along v at a facet h: reflected and refracted, each masked on
// its way out.
static void facet_shares(const struct microfacet *m, float eta, vec3 v, vec3 h, double *reflected,
                         double *transmitted) {
    const float c = dot(v, h);
    float cos_t;
    *reflected = *transmitted = 0;
    if (c <= 0)
        return;
    const float F = fresnel_dielectric(c, eta, &cos_t);
    const vec3 r = 2 * c * h - v;
    const vec3 t = (c / eta - cos_t) * h - v / eta;
    if (r[2] > 0)
        *reflected = F * microfacet_G1(m, r);
    if (t[2] < 0)
        *transmitted = (1 - F) * microfacet_G1(m, -t);
}

// Integral of f over the facets that v sees, with n x n nodes.
static void integrate_visible(const struct microfacet *m, vec3 v, int n,
                              void (*f)(const struct microfacet *m, float eta, vec3 v, vec3 h,
                                        double *a, double *b),
                              float eta, double *a, double *b) {
    enum { MOST = 256 };
    double x[MOST], w[MOST];
    assert(n <= MOST);
    gauss_legendre(n, x, w);
    // u = sin^2(pi x / 2) takes the square roots out of the maps' ends.
    for (int i = 0; i < n; i++) {
        w[i] *= 0.5 * M_PI * sin(M_PI * x[i]);
        x[i] = sqr(sinf((float)(0.5 * M_PI * x[i])));
    }
    *a = *b = 0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            double fa, fb;
            f(m, eta, v, microfacet_sample(m, v, (struct vec2){(float)x[i], (float)x[j]}), &fa,
              &fb);
            *a += w[i] * w[j] * fa;
            *b += w[i] * w[j] * fb;
        }
    }
}

static void mirror_share(const struct microfacet *m, float eta, vec3 v, vec3 h, double *reflected,
                         double *none) {
    const vec3 r = reflect(v, h);
    (void)eta;
    *reflected = r[2] > 0 ? (double)microfacet_G1(m, r) : 0;
    *none = 0;
}

void microfacet_albedo_from(const struct microfacet *m, float eta, vec3 v, int n,
                            double *reflected, double *transmitted) {
    integrate_visible(m, v, n, facet_shares, eta, reflected, transmitted);
}

void microfacet_albedo(const struct microfacet *m, float eta, float mu, int n, double *reflected,
                       double *transmitted) {
    const vec3 v = v3(safe_sqrt((1 - mu) * (1 + mu)), 0, mu);
    microfacet_albedo_from(m, eta, v, n, reflected, transmitted);
}

double microfacet_albedo_mirror(const struct microfacet *m, vec3 v, int n) {
    double reflected, none;
    integrate_visible(m, v, n, mirror_share, 1, &reflected, &none);
    return reflected;
}
