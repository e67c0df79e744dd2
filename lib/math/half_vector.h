// SPDX-License-Identifier: Apache-2.0
// Geometry of reflection at the half vector h = (wi + wo) / |wi + wo|, and the sampling that every
// model built on it can share.
//
// A half vector is drawn with a density p_h(h) that is symmetric about n; of h and its mirror
// image h' = (-h_x, -h_y, h_z), one is kept in proportion to what wo sees of each (Heitz 2014,
// Understanding the Masking-Shadowing Function, section 2.5: for p_h = D cos_h these are the
// visible normals of V-cavities). Since wo.h + wo.h' = 2 cos_h cos_o, the density of wi becomes
//
//     pdf_sa = p_h(h) / (4 cos_d) min(2, cos_d / (cos_h cos_o))
//
// and no half vector that faces away from wo is ever used.
#pragma once

#include "math/direction.h"

struct half_vector {
    struct direction h;
    double cos_o, cos_i; // of wo and wi with n
    double cos_h;        // of h with n
    double cos_d;        // of h with wo and with wi
};

// false: wi and wo are opposite.
static inline bool half_vector_make(struct direction wo, struct direction wi,
                                    struct half_vector *v) {
    const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
    const double length = sqrt(x * x + y * y + z * z), inv = length > 0 ? 1 / length : 0;
    v->h = (struct direction){x * inv, y * inv, z * inv};
    v->cos_o = wo.z;
    v->cos_i = wi.z;
    v->cos_h = v->h.z;
    v->cos_d = 0.5 * length;
    return length > 0;
}

// Density of wi, given the density of h.
static inline double half_vector_pdf(const struct half_vector *v, double pdf_h) {
    return fmin(0.5 * pdf_h / v->cos_d, 0.25 * pdf_h / (v->cos_h * v->cos_o));
}

// wi for a half vector drawn by pdf_h; u in [0, 1).
static inline struct direction half_vector_reflect(struct direction wo, struct direction h,
                                                   double u) {
    const struct direction other = {-h.x, -h.y, h.z};
    const double c = fmax(direction_dot(wo, h), 0), c1 = fmax(direction_dot(wo, other), 0);
    return direction_mirror(wo, u * (c + c1) < c ? h : other);
}

// Shadowing and masking of symmetric V-shaped grooves (Torrance and Sparrow 1967; Blinn 1977).
static inline double v_cavity(const struct half_vector *v) {
    return fmin(1, 2 * v->cos_h * fmin(v->cos_o, v->cos_i) / v->cos_d);
}

// Schlick 1994, eq. 15: from r0 at normal incidence to 1 at grazing.
static inline double schlick_weight(double cos_d) {
    const double m = fmax(1 - cos_d, 0), m2 = m * m;
    return m2 * m2 * m;
}

static inline double schlick_fresnel(double cos_d, double r0) {
    return r0 + (1 - r0) * schlick_weight(cos_d);
}
