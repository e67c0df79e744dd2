// SPDX-License-Identifier: Apache-2.0
// Rough metal: microfacets of a complex index (Walter et al. 2007, Microfacet Models for Refraction
// through Rough Surfaces; conductor's Fresnel term). Single scattering: light that leaves a facet
// for another one is lost.
#include "bsdf/roughness.h"
#include "bsdf/smooth.h"
#include "math/fresnel.h"

struct roughconductor {
    struct conductor_index index;
    struct roughness roughness;
    struct texture_ref reflectance;
};

struct roughconductor_data {
    struct closure head;
    struct microfacet facets;
    vec3 wo;
    float quarter_area; // 1 / (4 sigma(wo))
    spectrum eta, k, reflectance;
};

static const struct param params[] = {
    CONDUCTOR_INDEX_PARAMS(struct roughconductor, index),
    ROUGHNESS_PARAMS(struct roughconductor, roughness),
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct roughconductor, reflectance),
     .def = "1", .max = 1, .unit = "", .help = "factor on the reflection"},
    PARAM_END,
};

static bool prepare(struct object *self, struct arena *arena) {
    struct roughconductor *c = self->data;
    (void)arena;
    return conductor_index_prepare(&c->index, self) && roughness_prepare(&c->roughness, self);
}

static uint32_t lobes(const void *data) {
    const struct roughconductor *self = data;
    return roughness_lobes(&self->roughness) | LOBE_REFLECTION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct roughconductor *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    const spectrum reflectance = texture_eval(&self->reflectance, &point->at);
    struct microfacet facets;
    if (!roughness_at(&self->roughness, &point->at, &facets))
        return conductor_closure(self->index.eta, self->index.k, reflectance, wo, stack);
    struct roughconductor_data *c = closure_alloc(stack, &bsdf_roughconductor, sizeof *c,
                                                  LOBE_GLOSSY | LOBE_REFLECTION);
    c->facets = facets;
    c->wo = wo;
    c->quarter_area = 0.25f / microfacet_area(&facets, wo);
    c->eta = self->index.eta;
    c->k = self->index.k;
    c->reflectance = reflectance;
    return &c->head;
}

// f |cos_i| / pdf = F G1(wi)
static spectrum quotient(const struct roughconductor_data *c, vec3 h, vec3 wi) {
    return c->reflectance * fresnel_conductor(dot(c->wo, h), c->eta, c->k) *
           microfacet_G1(&c->facets, wi);
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct roughconductor_data *c = (const void *)closure;
    if (!(cos_theta(wi) > 0)) {
        *pdf_sa = 0;
        return spectrum_grey(0);
    }
    const vec3 h = normalize(c->wo + wi);
    *pdf_sa = microfacet_D(&c->facets, h) * c->quarter_area;
    return *pdf_sa > 0 ? quotient(c, h, wi) * *pdf_sa : spectrum_grey(0);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct roughconductor_data *c = (const void *)closure;
    (void)u1;
    const vec3 h = microfacet_sample(&c->facets, c->wo, u2);
    s->wi = normalize(reflect(c->wo, h));
    if (!(cos_theta(s->wi) > 0))
        return false; // the light met another facet
    s->pdf_sa = microfacet_D(&c->facets, h) * c->quarter_area;
    s->weight = quotient(c, h, s->wi);
    s->eta = 1;
    s->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    return s->pdf_sa > 0;
}

static spectrum albedo(const struct closure *closure) {
    const struct roughconductor_data *c = (const void *)closure;
    return c->reflectance * fresnel_conductor(cos_theta(c->wo), c->eta, c->k);
}

const struct bsdf_type bsdf_roughconductor = {
    .entry = {.name = "roughconductor", .help = "rough metal (Walter et al. 2007)",
              .params = params, .size = sizeof(struct roughconductor)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
