// SPDX-License-Identifier: Apache-2.0
// Rough metal: microfacets of a complex index (Walter et al. 2007, Microfacet Models for Refraction
// through Rough Surfaces; conductor's Fresnel term). Light that leaves a facet for another one is
// lost, or given back by a broad lobe (bsdf/facet_loss.h) of the colour that light has which meets
// facets again and again, F1^2 E1 / (1 - F1 (1 - E1)) with the means F1 of F and E1 of what escapes
// at once.
#include "bsdf/roughconductor.h"

#include "math/fresnel.h"
#include "math/quadrature.h"

struct roughconductor_data {
    struct closure head;
    struct microfacet facets;
    vec3 wo;
    float quarter_area; // 1 / (4 sigma(wo))
    spectrum eta, k, reflectance;
    bool compensated;
    struct facet_loss_at loss;
    spectrum regained; // of the broad lobe: f / lost(wi), times pi
    float p_regained;
};

static const struct param params[] = {
    CONDUCTOR_INDEX_PARAMS(struct roughconductor, index),
    ROUGHNESS_PARAMS(struct roughconductor, roughness),
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct roughconductor, reflectance),
     .def = "1", .max = 1, .unit = "", .help = "factor on the reflection"},
    ENERGY_PARAM(struct roughconductor, energy),
    PARAM_END,
};

static double mirror_albedo(const void *context, float alpha_u, float alpha_v, vec3 v,
                            int nodes) {
    const enum microfacet_type *type = context;
    const struct microfacet m = microfacet_make(*type, alpha_u, alpha_v);
    return microfacet_albedo_mirror(&m, v, nodes) + facet_albedo_error(nodes, false);
}

// 2 * integral of F(c) c dc
static spectrum mean_fresnel(spectrum eta, spectrum k) {
    enum { N = 24 };
    double c[N], w[N];
    spectrum sum = spectrum_grey(0);
    gauss_legendre(N, c, w);
    for (int i = 0; i < N; i++)
        sum += (float)(2 * w[i] * c[i]) * fresnel_conductor((float)c[i], eta, k);
    return sum;
}

static bool prepare(struct object *self, struct arena *arena) {
    struct roughconductor *c = self->data;
    if (!conductor_index_prepare(&c->index, self) || !roughness_prepare(&c->roughness, self))
        return false;
    c->rough = roughness_constant(&c->roughness, &c->facets);
    if (c->energy != ENERGY_COMPENSATED)
        return true;
    const enum microfacet_type type = (enum microfacet_type)c->roughness.distribution;
    c->mean_fresnel = mean_fresnel(c->index.eta, c->index.k);
    return roughness_loss(&c->roughness, self, mirror_albedo, &type, &c->loss, arena);
}

static uint32_t lobes(const void *data) {
    const struct roughconductor *self = data;
    return roughness_lobes(&self->roughness) | LOBE_REFLECTION;
}

static bool widen(const void *data, struct wide_material *m) {
    const struct roughconductor *self = data;
    m->kind = &roughconductor_wide[self->roughness.distribution];
    m->data = self;
    m->textured = self->reflectance.texture != NULL;
    return self->rough && self->energy != ENERGY_COMPENSATED;
}

static void resolve_regained(struct roughconductor_data *c, const struct roughconductor *self) {
    c->loss = facet_loss_at(&self->loss, c->facets.alpha_u);
    const float lost = facet_lost(&c->loss, c->wo), mean = c->loss.mean;
    const spectrum F = self->mean_fresnel * c->reflectance;
    const spectrum colour =
        spectrum_divide(F * F * (1 - mean), spectrum_grey(1) - F * mean + spectrum_grey(1e-20f));
    const float once =
        spectrum_mean(c->reflectance * fresnel_conductor(cos_theta(c->wo), c->eta, c->k)) *
        (1 - lost);
    const float again = spectrum_mean(colour) * lost;
    c->p_regained = once + again > 0 ? again / (once + again) : 0;
    c->regained = mean > 0 ? colour * (lost / mean) : spectrum_grey(0);
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
    c->compensated = self->energy == ENERGY_COMPENSATED;
    c->p_regained = 0;
    if (c->compensated)
        resolve_regained(c, self);
    return &c->head;
}

// f |cos_i| / pdf = F G1(wi)
static spectrum quotient(const struct roughconductor_data *c, vec3 h, vec3 wi) {
    return c->reflectance * fresnel_conductor(dot(c->wo, h), c->eta, c->k) *
           microfacet_G1(&c->facets, wi);
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct roughconductor_data *c = (const void *)closure;
    *pdf_sa = 0;
    if (!(cos_theta(wi) > 0))
        return spectrum_grey(0);
    const vec3 h = normalize(c->wo + wi);
    const float pdf = microfacet_D(&c->facets, h) * c->quarter_area;
    const spectrum once = pdf > 0 ? quotient(c, h, wi) * pdf : spectrum_grey(0);
    *pdf_sa = pdf;
    if (!c->compensated)
        return once;
    *pdf_sa = lerpf(c->p_regained, pdf, facet_loss_pdf_sa(&c->loss, wi));
    return once + c->regained * (facet_lost(&c->loss, wi) * INV_PI * cos_theta(wi));
}

static bool sample_compensated(const struct closure *closure, float u1, struct vec2 u2,
                               struct bsdf_sample *s) {
    const struct roughconductor_data *c = (const void *)closure;
    s->wi = u1 < c->p_regained
                ? facet_loss_sample(&c->loss, u2)
                : normalize(reflect(c->wo, microfacet_sample(&c->facets, c->wo, u2)));
    const spectrum f = eval(closure, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f / s->pdf_sa;
    s->eta = 1;
    s->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    return true;
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct roughconductor_data *c = (const void *)closure;
    if (c->compensated)
        return sample_compensated(closure, u1, u2, s);
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
    .albedo = albedo, .widen = widen,
};
