// SPDX-License-Identifier: Apache-2.0
// Roughness parameters that the rough materials share, and their value at a point.
#pragma once

#include "bsdf/bsdf.h"
#include "bsdf/facet_loss.h"
#include "math/microfacet.h"

struct roughness {
    int distribution; // enum microfacet_type
    struct texture_ref alpha, alpha_u, alpha_v;
};

// Rows of a parameter table, for `struct roughness` as member `m` of `type`.
#define ROUGHNESS_PARAMS(type, m)                                                                  \
    {"distribution", PARAM_CHOICE, offsetof(type, m.distribution), .def = "beckmann",             \
     .unit = "", .help = "distribution of facet normals", .choices = roughness_distributions},     \
    {"alpha", PARAM_TEXTURE_SCALAR, offsetof(type, m.alpha), .def = "0.1", .max = 1000,            \
     .unit = "", .help = "roughness; below 1e-4 the surface is smooth"},                           \
    {"alpha_u", PARAM_TEXTURE_SCALAR, offsetof(type, m.alpha_u), .def = "-1", .min = -1,           \
     .max = 1000, .unit = "", .help = "roughness along the tangent (-1: alpha)"},                  \
    {"alpha_v", PARAM_TEXTURE_SCALAR, offsetof(type, m.alpha_v), .def = "-1", .min = -1,           \
     .max = 1000, .unit = "", .help = "roughness along the bitangent (-1: alpha)"},                \
    {"sample_visible", PARAM_IGNORED, 0, .unit = "", .help = "visible normals are always sampled"}

extern const char *const roughness_distributions[];

// Refuses what the roughness parameters cannot mean.
bool roughness_prepare(const struct roughness *r, const struct object *self);

// LOBE_GLOSSY, LOBE_SPECULAR or both, whatever may occur on the surface.
uint32_t roughness_lobes(const struct roughness *r);

// Tabulates what the facets lose, over the roughness where that is textured. false after an error
// message: of textured anisotropic roughness there is no table.
bool roughness_loss(const struct roughness *r, const struct object *self, facet_albedo_fn albedo,
                    const void *context, struct facet_loss *loss, struct arena *arena);

// Whether the facets are the same everywhere, and rough; then they are *m.
bool roughness_constant(const struct roughness *r, struct microfacet *m);

// false: smooth here.
static inline bool roughness_at(const struct roughness *r, const struct texture_point *at,
                                struct microfacet *m) {
    float u = texture_eval_scalar(&r->alpha_u, at), v = u;
    if (u < 0)
        u = v = texture_eval_scalar(&r->alpha, at);
    else
        v = texture_eval_scalar(&r->alpha_v, at);
    if (!(maxf(u, v) >= MICROFACET_ALPHA_MIN))
        return false;
    *m = microfacet_make((enum microfacet_type)r->distribution, u, v);
    return true;
}
