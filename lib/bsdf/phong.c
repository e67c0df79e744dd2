// SPDX-License-Identifier: Apache-2.0
// Modified Phong model with normalised energy, f = kd / pi + ks (n + 2) / (2 pi) cos^n(theta_r);
// formulas and source in math/phong.h. Where kd + ks exceeds 1, both are scaled down alike.
#include "math/phong.h"

#include "bsdf/glossy.h"

struct phong {
    struct texture_ref diffuse, specular, exponent;
};

struct phong_data {
    struct glossy glossy;
    spectrum diffuse, specular;
    struct direction mirrored; // wo at the normal
    double exponent;
};

static const struct param params[] = {
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct phong, diffuse), .def = "0.5",
     .max = 1, .unit = "", .help = "reflectance kd of the base"},
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct phong, specular), .def = "0.2",
     .max = 1, .unit = "", .help = "reflectance ks of the highlight at normal incidence"},
    {"exponent", PARAM_TEXTURE_SCALAR, offsetof(struct phong, exponent), .def = "30", .max = 1e8,
     .unit = "", .help = "the greater, the sharper the highlight"},
    PARAM_END,
};

static uint32_t lobes(const void *data) {
    (void)data;
    return LOBE_DIFFUSE | LOBE_GLOSSY | LOBE_REFLECTION;
}

// What phong_brdf reflects of uniform light towards cos_o, roughly: exact for great exponents and
// for an exponent of 0.
static float share(double cos_o, double exponent) {
    return (float)(cos_o + (1 - cos_o) / (exponent + 2));
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct phong *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    spectrum diffuse = texture_eval(&self->diffuse, &point->at);
    spectrum specular = texture_eval(&self->specular, &point->at);
    const double exponent =
        (double)clampf(texture_eval_scalar(&self->exponent, &point->at), 0, 1e8f);
    glossy_limit(&diffuse, &specular);
    struct phong_data *c =
        glossy_alloc(stack, &bsdf_phong, sizeof *c, wo, diffuse,
                     specular * share((double)wo[2], exponent), LOBE_GLOSSY | LOBE_REFLECTION);
    if (!c)
        return NULL;
    c->diffuse = diffuse;
    c->specular = specular;
    c->mirrored = (struct direction){-c->glossy.wo.x, -c->glossy.wo.y, c->glossy.wo.z};
    c->exponent = exponent;
    return &c->glossy.head;
}

static struct glossy_value phong_eval(const struct glossy *g, struct direction wi) {
    const struct phong_data *c = (const void *)g;
    const double f = phong_brdf(g->wo, wi, c->exponent);
    return (struct glossy_value){c->specular * (float)(f * wi.z), c->diffuse,
                                 f * (c->exponent + 1) / (c->exponent + 2)};
}

static bool phong_sample(const struct glossy *g, double u1, struct vec2 u2, struct direction *wi) {
    const struct phong_data *c = (const void *)g;
    (void)u1;
    *wi = cosine_lobe_sample(c->mirrored, c->exponent, (double)u2.x, (double)u2.y);
    return true;
}

GLOSSY_FUNCTIONS(phong)

static spectrum albedo(const struct closure *closure) {
    const struct phong_data *c = (const void *)closure;
    return c->diffuse + c->specular * share(c->glossy.wo.z, c->exponent);
}

const struct bsdf_type bsdf_phong = {
    .entry = {.name = "phong",
              .help = "Phong highlight over a diffuse base (Lafortune and Willems 1994)",
              .params = params, .size = sizeof(struct phong)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample, .albedo = albedo,
};
