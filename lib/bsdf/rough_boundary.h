// SPDX-License-Identifier: Apache-2.0
// Refraction by the facets of a rough boundary (Walter et al. 2007, Microfacet Models for
// Refraction through Rough Surfaces), for the materials that have one.
//
// Conventions: wo above, wi below; eta is the index of wi's side over that of wo's. With
// h = wo + eta wi (unnormalised) refraction has the Jacobian eta^2 |<wi, h>| / |h|^2 of unit h, and
// |h| = |eta cos_t - cos_o| = |eta^2 - 1| / (eta cos_t + cos_o), which does not cancel as eta
// approaches 1.
#pragma once

#include "math/microfacet.h"

// Refraction that spreads less, as alpha |eta - 1|, is below what directions in float can tell
// apart.
#define REFRACTION_SPREAD_MIN 2e-6f

// The unit facet normal that refracts wo to wi; false: there is none.
static inline bool refracting_facet(float eta, vec3 wo, vec3 wi, vec3 *h) {
    *h = normalize(wo + eta * wi);
    if ((*h)[2] < 0)
        *h = -*h;
    return dot(wo, *h) > 0 && dot(wi, *h) < 0;
}

// Where the facet h, under which wo has the cosine cos_o and its refraction cos_t, sends it.
static inline vec3 refract_at_facet(float eta, vec3 wo, vec3 h, float cos_o, float cos_t) {
    return normalize((cos_o / eta - cos_t) * h - wo / eta);
}

// Density of that direction when facets are chosen as wo sees them; inv_area is 1 / sigma(wo).
static inline float refracted_pdf_sa(const struct microfacet *m, float inv_area, float eta, vec3 h,
                                     float cos_o, float cos_t) {
    const float q = eta * cos_t, d = (eta - 1) * (eta + 1);
    return microfacet_D(m, h) * inv_area * cos_o * eta * q * sqr((q + cos_o) / d);
}
