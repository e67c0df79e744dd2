// SPDX-License-Identifier: Apache-2.0
// Smooth boundary between two dielectrics: reflection and refraction. The interior is the side
// opposite to the normal. With equal indices nothing is there: light passes straight through.
#include "bsdf/smooth.h"
#include "math/fresnel.h"

struct dielectric {
    struct dielectric_index index;
    struct texture_ref reflectance, transmittance;
};

struct dielectric_data {
    struct closure head;
    vec3 reflected, refracted;
    float F;
    float eta; // of the far side over wo's
    spectrum reflectance, transmittance; // the latter includes the radiance's scaling
};

static const struct param params[] = {
    DIELECTRIC_INDEX_PARAMS(struct dielectric, index, "bk7"),
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct dielectric, reflectance), .def = "1",
     .max = 1, .unit = "", .help = "factor on the reflection"},
    {"specular_transmittance", PARAM_TEXTURE, offsetof(struct dielectric, transmittance),
     .def = "1", .max = 1, .unit = "", .help = "factor on the refraction"},
    PARAM_END,
};

uint32_t dielectric_lobes(float eta) {
    if (eta == 1)
        return LOBE_NULL | LOBE_TRANSMISSION;
    return LOBE_SPECULAR | LOBE_REFLECTION | LOBE_TRANSMISSION;
}

const struct closure *dielectric_closure(float eta, spectrum reflectance, spectrum transmittance,
                                         vec3 wo, struct closure_stack *stack) {
    if (cos_theta(wo) == 0)
        return NULL;
    struct dielectric_data *c =
        closure_alloc(stack, &bsdf_dielectric, sizeof *c, dielectric_lobes(eta));
    const bool outside = cos_theta(wo) > 0;
    float cos_t;
    c->eta = outside ? eta : 1 / eta;
    c->F = fresnel_dielectric(fabsf(cos_theta(wo)), c->eta, &cos_t);
    c->reflected = v3(-wo[0], -wo[1], wo[2]);
    if (eta == 1)
        c->refracted = -wo;
    else
        c->refracted = normalize(v3(-wo[0] / c->eta, -wo[1] / c->eta, outside ? -cos_t : cos_t));
    c->reflectance = reflectance;
    c->transmittance = transmittance / (c->eta * c->eta);
    return &c->head;
}

static uint32_t lobes(const void *data) {
    const struct dielectric *self = data;
    return dielectric_lobes(self->index.int_ior / self->index.ext_ior);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct dielectric *self = data;
    return dielectric_closure(self->index.int_ior / self->index.ext_ior,
                              texture_eval(&self->reflectance, &point->at),
                              texture_eval(&self->transmittance, &point->at), wo, stack);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct dielectric_data *c = (const void *)closure;
    (void)u2;
    const uint32_t delta = c->head.lobes & LOBE_DELTA;
    if (u1 < c->F)
        *s = (struct bsdf_sample){c->reflected, c->reflectance, c->F, 1, delta | LOBE_REFLECTION};
    else
        *s = (struct bsdf_sample){c->refracted, c->transmittance, 1 - c->F, c->eta,
                                  delta | LOBE_TRANSMISSION};
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct dielectric_data *c = (const void *)closure;
    return c->F * c->reflectance + (1 - c->F) * c->eta * c->eta * c->transmittance;
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    const struct dielectric *self = data;
    (void)wo;
    if (self->index.int_ior != self->index.ext_ior)
        return spectrum_grey(0);
    return texture_eval(&self->transmittance, &point->at);
}

const struct bsdf_type bsdf_dielectric = {
    .entry = {.name = "dielectric", .help = "smooth boundary of glass, water, ...",
              .params = params, .size = sizeof(struct dielectric)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY | CLAIM_LOSSLESS,
    .lobes = lobes, .resolve = resolve, .eval = closure_eval_delta, .sample = sample, .albedo = albedo,
    .null_transmittance = null_transmittance,
};
