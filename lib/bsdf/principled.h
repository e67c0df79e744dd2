// SPDX-License-Identifier: Apache-2.0
// What principled and principledthin share (Burley 2012, Physically Based Shading at Disney; 2015,
// Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering), in Mitsuba 3's
// conventions. All cosines are positive.
#pragma once

#include "bsdf/bsdf.h"
#include "math/microfacet.h"

// A texture's value as a share.
static inline float principled_share(const struct texture_ref *r, const struct texture_point *at) {
    return clampf(texture_eval_scalar(r, at), 0, 1);
}

// Whether a share can be other than zero anywhere.
static inline bool principled_has(const struct texture_ref *r) {
    return r->texture || r->value[0] > 0;
}

// (1 - c)^5, by which reflectance rises to grazing angles (Schlick 1994)
static inline float schlick_weight(float c) {
    const float m = clampf(1 - c, 0, 1);
    return sqr(sqr(m)) * m;
}

// The same for a boundary of index eta (far over near): below 1 the refracted cosine counts.
static inline float schlick_weight_eta(float cos_i, float cos_t, float eta) {
    return schlick_weight(eta > 1 ? cos_i : cos_t);
}

// Hue and saturation of a colour, of luminance 1; white for black.
static inline spectrum principled_tint(spectrum colour) {
    const float luminance = spectrum_luminance(colour);
    return luminance > 0 ? colour / luminance : spectrum_grey(1);
}

// Facets of the main specular lobes (Burley 2012, 5.4; bounded as in Mitsuba).
static inline struct microfacet principled_facets(float roughness, float anisotropic) {
    const float a = sqr(roughness), aspect = sqrtf(1 - 0.9f * anisotropic);
    return microfacet_make(MICROFACET_GGX, maxf(0.001f, a / aspect), maxf(0.001f, a * aspect));
}

// pi f cos_i over the base colour: diffuse with retro-reflection, blended with a flatter lobe in
// the manner of Hanrahan and Krueger 1993. cos_d is the cosine between the half vector and wi.
static inline float principled_diffuse(float roughness, float flatness, float cos_o, float cos_i,
                                       float cos_d) {
    const float Fo = schlick_weight(cos_o), Fi = schlick_weight(cos_i);
    const float diffuse = (1 - 0.5f * Fi) * (1 - 0.5f * Fo);
    const float Rr = 2 * roughness * sqr(cos_d);
    const float retro = Rr * (Fo + Fi + Fo * Fi * (Rr - 1));
    const float Fss90 = 0.5f * Rr, Fss = lerpf(Fo, 1, Fss90) * lerpf(Fi, 1, Fss90);
    const float flat = 1.25f * (Fss * (cos_i / (cos_o + cos_i) - 0.5f * cos_i) + 0.5f * cos_i);
    return lerpf(flatness, cos_i * (diffuse + retro), flat);
}

#define PRINCIPLED_BASE_PARAMS(type)                                                               \
    {"base_color", PARAM_TEXTURE, offsetof(type, base_color), .def = "0.5", .max = 1, .unit = "",  \
     .help = "colour of the material"},                                                            \
    {"roughness", PARAM_TEXTURE_SCALAR, offsetof(type, roughness), .def = "0.5", .max = 1,         \
     .unit = "", .help = "square root of the main lobes' alpha"},                                  \
    {"anisotropic", PARAM_TEXTURE_SCALAR, offsetof(type, anisotropic), .def = "0", .max = 1,       \
     .unit = "", .help = "stretches the highlight along the tangent"},                             \
    {"spec_trans", PARAM_TEXTURE_SCALAR, offsetof(type, spec_trans), .def = "0", .max = 1,         \
     .unit = "", .help = "from opaque (0) to glass (1)"},                                          \
    {"spec_tint", PARAM_TEXTURE_SCALAR, offsetof(type, spec_tint), .def = "0", .max = 1,           \
     .unit = "", .help = "tint of the dielectric reflection by the base colour"},                  \
    {"sheen", PARAM_TEXTURE_SCALAR, offsetof(type, sheen), .def = "0", .max = 1, .unit = "",       \
     .help = "brightness at grazing angles, as of cloth"},                                         \
    {"sheen_tint", PARAM_TEXTURE_SCALAR, offsetof(type, sheen_tint), .def = "0", .max = 1,         \
     .unit = "", .help = "tint of the sheen by the base colour"},                                  \
    {"flatness", PARAM_TEXTURE_SCALAR, offsetof(type, flatness), .def = "0", .max = 1,             \
     .unit = "", .help = "from diffuse (0) to an imitation of subsurface scattering (1)"}

// Row for a factor on the probability with which a lobe is sampled.
#define PRINCIPLED_RATE_PARAM(type, member, parameter, what)                                       \
    {parameter, PARAM_FLOAT, offsetof(type, member), .def = "1", .max = 1e6, .unit = "",           \
     .help = "factor on the rate of sampling the " what}
