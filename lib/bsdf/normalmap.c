// SPDX-License-Identifier: Apache-2.0
// A material whose normals a picture gives: (x, y, z) in the shading frame as colours (x + 1) / 2.
// The picture must be read with raw = true.
#include "bsdf/perturbed.h"

struct normalmap {
    struct texture_ref normal;
    const struct object *child;
    struct perturbation perturbation;
};

static const struct param params[] = {
    {"normalmap", PARAM_TEXTURE, offsetof(struct normalmap, normal), .unit = "",
     .help = "normals as colours"},
    {"bsdf", PARAM_BSDF, offsetof(struct normalmap, child), .unit = "",
     .help = "material of the surface"},
    PERTURBATION_PARAMS(struct normalmap, perturbation),
    PARAM_END,
};

static bool prepare(struct object *self, struct arena *arena) {
    (void)arena;
    return bsdf_check_nesting(self);
}

static uint32_t lobes(const void *data) {
    return bsdf_lobes(((const struct normalmap *)data)->child) | LOBE_ANISOTROPIC;
}

// The one place where lanes of a spectrum are not a colour.
static vec3 mapped_normal(const struct normalmap *self, const struct bsdf_point *point) {
    const spectrum t = texture_eval(&self->normal, &point->at);
    return v3(2 * t[0] - 1, 2 * t[1] - 1, 2 * t[2] - 1);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct normalmap *self = data;
    return perturbed_resolve(&self->perturbation, self->child, mapped_normal(self, point), point,
                             wo, stack);
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    const struct normalmap *self = data;
    return perturbed_null_transmittance(&self->perturbation, self->child,
                                        mapped_normal(self, point), point, wo);
}

const struct bsdf_type bsdf_normalmap = {
    .entry = {.name = "normalmap", .help = "normals from a picture", .params = params,
              .size = sizeof(struct normalmap)},
    .claims = CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = perturbed_eval,
    .sample = perturbed_sample, .albedo = perturbed_albedo, .inside = perturbed_inside,
    .null_transmittance = null_transmittance,
};
