// SPDX-License-Identifier: Apache-2.0
// A material whose normals are those of a height field over the surface (Blinn 1978, Simulation of
// Wrinkled Surfaces), heights in metres.
#include "bsdf/perturbed.h"

struct bumpmap {
    struct texture_ref height;
    const struct object *child;
    float scale;
    struct perturbation perturbation;
};

static const struct param params[] = {
    {"texture", PARAM_TEXTURE_SCALAR, offsetof(struct bumpmap, height), .unit = "m",
     .help = "height above the surface", .aka = "arbitrary"},
    {"bsdf", PARAM_BSDF, offsetof(struct bumpmap, child), .unit = "",
     .help = "material of the surface"},
    {"scale", PARAM_FLOAT, offsetof(struct bumpmap, scale), .def = "1", .unit = "",
     .help = "factor on the height"},
    PERTURBATION_PARAMS(struct bumpmap, perturbation),
    PARAM_END,
};

static bool prepare(struct object *self, struct arena *arena) {
    (void)arena;
    return bsdf_check_nesting(self);
}

static uint32_t lobes(const void *data) {
    return bsdf_lobes(((const struct bumpmap *)data)->child) | LOBE_ANISOTROPIC;
}

// cross(dpdu + n h_u, dpdv + n h_v) in the local frame, with dpdu and dpdv taken tangential, and
// turned to the side of n where (u, v) is left-handed.
static vec3 bumped_normal(const struct bumpmap *self, const struct bsdf_point *point) {
    const struct vec2 g = texture_gradient(&self->height, &point->at);
    const float hu = self->scale * g.x, hv = self->scale * g.y;
    const vec3 u = to_local(&point->frame, point->dpdu), v = to_local(&point->frame, point->dpdv);
    const float det = u[0] * v[1] - u[1] * v[0];
    if (det == 0)
        return v3(0, 0, 1);
    return v3(hv * u[1] - hu * v[1], hu * v[0] - hv * u[0], det) * copysignf(1, det);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct bumpmap *self = data;
    return perturbed_resolve(&self->perturbation, self->child, bumped_normal(self, point), point,
                             wo, stack);
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    const struct bumpmap *self = data;
    return perturbed_null_transmittance(&self->perturbation, self->child,
                                        bumped_normal(self, point), point, wo);
}

static const char *const aliases[] = {"bump", NULL};

const struct bsdf_type bsdf_bumpmap = {
    .entry = {.name = "bumpmap", .help = "normals of a height field (Blinn 1978)",
              .aliases = aliases, .params = params, .size = sizeof(struct bumpmap)},
    .claims = CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = perturbed_eval,
    .sample = perturbed_sample, .albedo = perturbed_albedo, .inside = perturbed_inside,
    .null_transmittance = null_transmittance,
};
