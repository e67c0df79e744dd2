// SPDX-License-Identifier: Apache-2.0
// The angle-like quantities gamma that curves depend on.
//
// Conventions: directions are unit vectors of the local shading frame, n = +z, tangent +x, both on
// the upper side; wi towards the light, wo towards the eye; h = wi + wo, normalised. gamma lies in
// [0, pi/2], but for theta_r, which reaches pi (curves are 0 there). Angles come from arc tangents:
// an arc cosine loses half the digits near 0.
#pragma once

enum gamma_kind {
    GAMMA_NONE,    // 0: a slot without curve
    GAMMA_THETA_H, // n to h
    GAMMA_THETA_D, // h to wi: half the angle between wi and wo
    GAMMA_THETA_I, // n to wi
    GAMMA_THETA_O, // n to wo
    GAMMA_THETA_R, // wi to the mirror direction of wo
    GAMMA_PHI_H,   // azimuth of h, folded into [0, pi/2] from the tangent
    GAMMA_POWER_U, // arc cosine of cos(theta_h)^(cos(phi_h)^2) (Ashikhmin, Shirley 2000)
    GAMMA_POWER_V, // arc cosine of cos(theta_h)^(sin(phi_h)^2)
    GAMMA_RATIO,   // arc tangent of sqrt(-2 log cos(theta_h)^(n sin(phi_h)^2)), n fixed
    GAMMA_SLOPE_U, // arc tangent of h's slope along the tangent (Ward 1992)
    GAMMA_SLOPE_V, // and across it
    GAMMA_COUNT,
};

extern const char *const gamma_names[]; // "none", "theta_h", ..., NULL

struct gamma {
    enum gamma_kind kind;
    double n; // exponent of GAMMA_RATIO
};

// Whether gamma depends on h alone.
static inline int gamma_is_half(enum gamma_kind k) {
    return k == GAMMA_THETA_H || (k >= GAMMA_PHI_H && k <= GAMMA_SLOPE_V);
}

struct angles {
    double cos_i, cos_o, cos_d, sin_d;
    double cos_h, sin_h;
    double h[3];               // wi + wo, not normalised
    double cos2_phi, sin2_phi; // of h's azimuth; 1 and 0 where h is the normal
    double log_h;              // -log(cos_h), without cancellation; negative: not asked for yet
    double known[GAMMA_COUNT]; // gammas that were asked for already; negative: not yet
    double wi[3], wo[3];
};

struct angles angles_make(const double wo[3], const double wi[3]);
// Remembered in `a`, but for GAMMA_RATIO, whose exponent may differ from term to term.
double gamma_at(const struct gamma *g, struct angles *a);
// -log(cos theta_h)
double angles_log(struct angles *a);
