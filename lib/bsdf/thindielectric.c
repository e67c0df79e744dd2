// SPDX-License-Identifier: Apache-2.0
// A thin pane: both its faces, and all reflections between them, as one surface that light crosses
// without bending (Stokes 1862: the sum r + t r t + t r^3 t + ... = 2 r / (1 + r)).
#include "bsdf/smooth.h"
#include "math/fresnel.h"

struct thindielectric {
    struct dielectric_index index;
    struct texture_ref reflectance, transmittance;
};

struct thin_data {
    struct closure head;
    vec3 wo;
    float R;
    spectrum reflectance, transmittance;
};

static const struct param params[] = {
    DIELECTRIC_INDEX_PARAMS(struct thindielectric, index, "bk7"),
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct thindielectric, reflectance),
     .def = "1", .max = 1, .unit = "", .help = "factor on the reflection"},
    {"specular_transmittance", PARAM_TEXTURE, offsetof(struct thindielectric, transmittance),
     .def = "1", .max = 1, .unit = "", .help = "factor on what passes"},
    PARAM_END,
};

static float pane_reflectance(const struct thindielectric *self, vec3 wo) {
    float cos_t;
    const float r = fresnel_dielectric(fabsf(cos_theta(wo)),
                                       self->index.int_ior / self->index.ext_ior, &cos_t);
    return 2 * r / (1 + r);
}

static uint32_t lobes(const void *data) {
    const struct thindielectric *self = data;
    if (self->index.int_ior == self->index.ext_ior)
        return LOBE_NULL | LOBE_TRANSMISSION;
    return LOBE_SPECULAR | LOBE_NULL | LOBE_REFLECTION | LOBE_TRANSMISSION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct thindielectric *self = data;
    struct thin_data *c = closure_alloc(stack, &bsdf_thindielectric, sizeof *c, lobes(data));
    c->wo = wo;
    c->R = pane_reflectance(self, wo);
    c->reflectance = texture_eval(&self->reflectance, &point->at);
    c->transmittance = texture_eval(&self->transmittance, &point->at);
    return &c->head;
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct thin_data *c = (const void *)closure;
    (void)u2;
    if (u1 < c->R)
        *s = (struct bsdf_sample){v3(-c->wo[0], -c->wo[1], c->wo[2]), c->reflectance, c->R, 1,
                                  LOBE_SPECULAR | LOBE_REFLECTION};
    else
        *s = (struct bsdf_sample){-c->wo, c->transmittance, 1 - c->R, 1,
                                  LOBE_NULL | LOBE_TRANSMISSION};
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct thin_data *c = (const void *)closure;
    return c->R * c->reflectance + (1 - c->R) * c->transmittance;
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    const struct thindielectric *self = data;
    return (1 - pane_reflectance(self, wo)) * texture_eval(&self->transmittance, &point->at);
}

const struct bsdf_type bsdf_thindielectric = {
    .entry = {.name = "thindielectric", .help = "thin pane of glass", .params = params,
              .size = sizeof(struct thindielectric)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY | CLAIM_LOSSLESS,
    .lobes = lobes, .resolve = resolve, .eval = closure_eval_delta, .sample = sample, .albedo = albedo,
    .null_transmittance = null_transmittance,
};
