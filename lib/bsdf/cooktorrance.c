// SPDX-License-Identifier: Apache-2.0
// Cook and Torrance's metal: Beckmann's slopes in V-shaped grooves, and the Fresnel reflectance
// of a complex index per channel, f = kd / pi + ks F D G / (4 cos_o cos_i); formulas, source and
// the paper's other normalisation in math/cook_torrance.h. Where kd + ks exceeds 1, both are
// scaled down alike.
#include "math/cook_torrance.h"

#include "bsdf/glossy.h"
#include "bsdf/smooth.h"
#include "math/fresnel.h"

struct cooktorrance {
    struct conductor_index index;
    struct texture_ref diffuse, specular, alpha;
};

struct cooktorrance_data {
    struct glossy glossy;
    spectrum diffuse, specular;
    spectrum eta, k;
    struct beckmann slopes;
};

static const struct param params[] = {
    CONDUCTOR_INDEX_PARAMS(struct cooktorrance, index),
    {"alpha", PARAM_TEXTURE_SCALAR, offsetof(struct cooktorrance, alpha), .def = "0.1", .max = 10,
     .unit = "", .help = "roughness m: root mean square slope times sqrt 2; at least 1e-4 is taken",
     .aka = "m"},
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct cooktorrance, specular), .def = "1",
     .max = 1, .unit = "", .help = "factor ks on the metal's reflection"},
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct cooktorrance, diffuse), .def = "0",
     .max = 1, .unit = "", .help = "reflectance kd of a diffuse part"},
    PARAM_END,
};

static bool prepare(struct object *self, struct arena *arena) {
    struct cooktorrance *c = self->data;
    (void)arena;
    return conductor_index_prepare(&c->index, self);
}

static uint32_t lobes(const void *data) {
    (void)data;
    return LOBE_DIFFUSE | LOBE_GLOSSY | LOBE_REFLECTION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct cooktorrance *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    spectrum diffuse = texture_eval(&self->diffuse, &point->at);
    spectrum specular = texture_eval(&self->specular, &point->at);
    const double m = (double)clampf(texture_eval_scalar(&self->alpha, &point->at),
                                    GLOSSY_ROUGHNESS_MIN, 10);
    glossy_limit(&diffuse, &specular);
    const spectrum F = fresnel_conductor(cos_theta(wo), self->index.eta, self->index.k);
    struct cooktorrance_data *c =
        glossy_alloc(stack, &bsdf_cooktorrance, sizeof *c, wo, diffuse,
                     specular * maxf(spectrum_mean(F), 0.02f), LOBE_GLOSSY | LOBE_REFLECTION);
    if (!c)
        return NULL;
    c->diffuse = diffuse;
    c->specular = specular;
    c->eta = self->index.eta;
    c->k = self->index.k;
    c->slopes = (struct beckmann){m, m};
    return &c->glossy.head;
}

static struct glossy_value cooktorrance_eval(const struct glossy *g, struct direction wi) {
    const struct cooktorrance_data *c = (const void *)g;
    struct half_vector v;
    struct glossy_value value = {.base = c->diffuse};
    if (!half_vector_make(g->wo, wi, &v))
        return value;
    const double D = beckmann_D(&c->slopes, v.h);
    if (!(D > 0))
        return value;
    const spectrum F = fresnel_conductor((float)v.cos_d, c->eta, c->k);
    value.f_cos = c->specular * F * (float)(D * v_cavity(&v) / (4 * v.cos_o));
    value.pdf_sa = half_vector_pdf(&v, D * v.cos_h);
    return value;
}

static bool cooktorrance_sample(const struct glossy *g, double u1, struct vec2 u2,
                                struct direction *wi) {
    const struct cooktorrance_data *c = (const void *)g;
    const struct direction h = beckmann_sample(&c->slopes, (double)u2.x, (double)u2.y);
    *wi = half_vector_reflect(g->wo, h, u1);
    return true;
}

GLOSSY_FUNCTIONS(cooktorrance)

static spectrum albedo(const struct closure *closure) {
    const struct cooktorrance_data *c = (const void *)closure;
    return c->diffuse + c->specular * fresnel_conductor((float)c->glossy.wo.z, c->eta, c->k);
}

const struct bsdf_type bsdf_cooktorrance = {
    .entry = {.name = "cooktorrance",
              .help = "metal of V-shaped grooves with Beckmann slopes (Cook and Torrance 1982)",
              .params = params, .size = sizeof(struct cooktorrance)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
