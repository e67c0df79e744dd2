// SPDX-License-Identifier: Apache-2.0
// Diffusion dipole: where light that entered a half space of a scattering medium comes out again.
//
// Jensen, Marschner, Levoy, Hanrahan 2001, A Practical Model for Subsurface Light Transport: light
// becomes diffuse at a point source one reduced free path z_r below the entry; a negative source at
// z_v above the surface keeps the boundary. R_d(r) is the exitance at distance r from the entry per
// power that passed the boundary there. d'Eon 2012, A Better Dipole, takes Grosjean's diffusion, the
// boundary of d'Eon and Irving 2011, and both fluence and flux at the surface.
//
// Conventions: lane by lane; coefficients reduced, per unit of length; r in that unit; densities per
// area of the plane. With q(r) = z (1 + s d) exp(-s d) / (2 pi d^3), d^2 = r^2 + z^2, s = sigma_tr:
//     R_d = flux (q_r + q_v) + fluence (exp(-s d_r) / d_r - exp(-s d_v) / d_v).
// The integral of q over the plane is exp(-s z) and its distribution inverts in closed form, so that
// what is sampled is Jensen's R_d exactly; the ratio of d'Eon's to it is bounded.
#pragma once

#include "math/elementary.h"
#include "math/vec.h"

enum dipole_model {
    DIPOLE_JENSEN,
    DIPOLE_BETTER,
};

struct dipole {
    spectrum sigma_tr, z_r, z_v;
    spectrum flux, fluence;
    spectrum pick_r, pick_v; // probabilities to sample by a source; 1 in all, unless it is black
};

// Moments of Fresnel reflectance inside, eta = inside over outside: 2 C_1 = 2 * integral of F c dc,
// 3 C_2 = 3 * integral of F c^2 dc (fits of d'Eon and Irving 2011, A Quantized-Diffusion Model for
// Rendering Translucent Materials, to 0.005 for eta from 1 to 2).
static inline float dipole_2c1(float eta) {
    const float e2 = eta * eta, e3 = e2 * eta, e4 = e3 * eta, e5 = e4 * eta;
    const float c = eta < 1 ? 0.919317f - 3.4793f * eta + 6.75335f * e2 - 7.80989f * e3 +
                                  4.98554f * e4 - 1.36881f * e5
                            : -9.23372f + 22.2272f * eta - 20.9292f * e2 + 10.2291f * e3 -
                                  2.54396f * e4 + 0.254913f * e5;
    return clampf(c, 0, 0.999f);
}

static inline float dipole_3c2(float eta) {
    const float e2 = eta * eta, e3 = e2 * eta, e4 = e3 * eta, e5 = e4 * eta;
    const float c = eta < 1 ? 0.828421f - 2.62051f * eta + 3.36231f * e2 - 1.95284f * e3 +
                                  0.236494f * e4 + 0.145787f * e5
                            : -1641.1f + 135.926f / e3 - 656.175f / e2 + 1376.53f / eta +
                                  1213.67f * eta - 568.556f * e2 + 164.798f * e3 - 27.0181f * e4 +
                                  1.91826f * e5;
    return clampf(c, 0, 0.999f);
}

// Share of diffuse light from outside that passes the boundary; the boundary exchanges equal powers
// both ways.
static inline float dipole_diffuse_transmittance(float eta) {
    return minf(eta * eta * (1 - dipole_2c1(eta)), 1);
}

// One lane: the sources, how bright they are, and the weights they are sampled by.
static inline void dipole_set_lane(struct dipole *d, int i, float sigma_s, float sigma_a, float eta,
                                   enum dipole_model model) {
    const float least = 1e-15f, most = 1e15f; // free paths whose squares are numbers
    const float scale = 1 / clampf(sigma_s + sigma_a, least, most);
    const float alpha = sigma_s / maxf(sigma_s + sigma_a, least);
    const float absorbed = sigma_a / maxf(sigma_s + sigma_a, least);
    const float inside = 1 - dipole_2c1(eta);
    float D = 1.0f / 3, boundary = 1 + dipole_2c1(eta); // in free paths
    d->flux[i] = 0.5f * alpha;
    d->fluence[i] = 0;
    if (model == DIPOLE_BETTER) {
        D = (1 + absorbed) / 3;
        boundary = 1 + dipole_3c2(eta);
        d->flux[i] = 0.25f * alpha * alpha * (1 - dipole_3c2(eta));
        d->fluence[i] = alpha * alpha * 0.25f * inside * (0.25f * INV_PI) / (D * scale);
    }
    d->z_r[i] = scale;
    d->z_v[i] = scale * (1 + 4 * D * boundary / inside);
    d->sigma_tr[i] = sqrtf(absorbed / D) / scale;
    d->pick_r[i] = alpha * fast_exp(-d->sigma_tr[i] * d->z_r[i]);
    d->pick_v[i] = alpha * fast_exp(-d->sigma_tr[i] * d->z_v[i]);
}

// Reduced coefficients of scattering and absorption; eta of the inside over the outside.
static inline struct dipole dipole_make(spectrum sigma_s, spectrum sigma_a, float eta,
                                        enum dipole_model model) {
    struct dipole d = {.sigma_tr = spectrum_grey(0)};
    for (int i = 0; i < SPECTRUM_LANES; i++)
        dipole_set_lane(&d, i, sigma_s[i], sigma_a[i], eta, model);
    const float sum = SPECTRUM_LANES * spectrum_mean(d.pick_r + d.pick_v);
    if (sum > 0) {
        d.pick_r /= sum;
        d.pick_v /= sum;
    }
    return d;
}

// z (1 + s d) exp(-s (d - lift)) / (2 pi d^3)
static inline float dipole_source(float s, float z, float r2, float lift) {
    const float d2 = r2 + z * z, d = sqrtf(d2);
    return z / d * (1 + s * d) * fast_exp(-s * (d - lift)) * (0.5f * INV_PI) / d2;
}

static inline spectrum dipole_Rd(const struct dipole *m, float r) {
    spectrum Rd = spectrum_grey(0);
    for (int i = 0; i < SPECTRUM_LANES; i++) {
        const float s = m->sigma_tr[i], zr = m->z_r[i], zv = m->z_v[i];
        Rd[i] = m->flux[i] * (dipole_source(s, zr, r * r, 0) + dipole_source(s, zv, r * r, 0));
        if (m->fluence[i] == 0)
            continue;
        const float dr = sqrtf(r * r + zr * zr), dv = sqrtf(r * r + zv * zv);
        const float apart = (zv - zr) * (zv + zr) / (dv + dr); // d_v - d_r
        const float fluence = (apart - dr * expm1f(-s * apart)) / dr / dv;
        Rd[i] += m->fluence[i] * fast_exp(-s * dr) * fluence;
    }
    return Rd;
}

// Integral of R_d over the plane.
static inline spectrum dipole_albedo(const struct dipole *m) {
    spectrum albedo = spectrum_grey(0);
    for (int i = 0; i < SPECTRUM_LANES; i++) {
        const float s = m->sigma_tr[i], gap = m->z_v[i] - m->z_r[i];
        const float er = fast_exp(-s * m->z_r[i]), ev = fast_exp(-s * m->z_v[i]);
        const float between = s * gap > 1e-6f ? -expm1f(-s * gap) / s : gap;
        albedo[i] = m->flux[i] * (er + ev) + m->fluence[i] * TWO_PI * er * between;
    }
    return albedo;
}

// Density per area of dipole_sample at a distance.
static inline float dipole_pdf_area(const struct dipole *m, float r) {
    float pdf = 0;
    for (int i = 0; i < SPECTRUM_LANES; i++) {
        const float s = m->sigma_tr[i], zr = m->z_r[i], zv = m->z_v[i];
        pdf += m->pick_r[i] * dipole_source(s, zr, r * r, zr) +
               m->pick_v[i] * dipole_source(s, zv, r * r, zv);
    }
    return pdf;
}

// Distance d from a source at depth z with z / d exp(-s (d - z)) = 1 - u: y = s d solves
// y + ln y = L, which is Lambert's W of exp(L); Newton from its asymptotes.
static inline float dipole_invert(float s, float z, float u) {
    const float log_left = fast_log(1 - u);
    if (!(s * z > 1e-20f))
        return z / (1 - u);
    const float L = fast_log(s * z) + s * z - log_left;
    float y = L > 1 ? L - fast_log(L) : fast_exp(minf(L, 0));
    for (int i = 0; i < 4; i++)
        y *= (1 + L - fast_log(y)) / (1 + y);
    return maxf(y / s, z);
}

// A distance; u1 chooses the source, u2 the distance, both in [0, 1). Not for a black one.
static inline float dipole_sample(const struct dipole *m, float u1, float u2) {
    float s = 0, z = 0;
    for (int i = 0; i < 2 * SPECTRUM_LANES; i++) {
        const int lane = i / 2;
        const float pick = i % 2 ? m->pick_v[lane] : m->pick_r[lane];
        if (!(pick > 0))
            continue;
        s = m->sigma_tr[lane];
        z = i % 2 ? m->z_v[lane] : m->z_r[lane];
        if (u1 < pick)
            break;
        u1 -= pick;
    }
    const float d = dipole_invert(s, z, u2);
    return sqrtf((d - z) * (d + z));
}

static inline bool dipole_is_black(const struct dipole *m) {
    return spectrum_is_black(m->pick_r);
}

// Less than a millionth of the light of any lane comes from further away.
static inline float dipole_reach(const struct dipole *m) {
    const float share = 1e-6f, logarithm = 14;
    float reach = 0;
    for (int i = 0; i < SPECTRUM_LANES; i++)
        if (m->pick_r[i] > 0)
            reach = maxf(reach, minf(m->z_v[i] / share,
                                     m->z_v[i] + logarithm / maxf(m->sigma_tr[i], 1e-30f)));
    return reach;
}
