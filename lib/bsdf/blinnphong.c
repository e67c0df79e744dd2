// SPDX-License-Identifier: Apache-2.0
// Blinn-Phong highlight as a surface of microfacets in V-shaped grooves, f = kd / pi + ks F D G /
// (4 cos_o cos_i); formulas and source in math/blinn_phong.h. Where kd + ks exceeds 1, both are
// scaled down alike.
#include "math/blinn_phong.h"

#include "bsdf/glossy.h"

struct blinnphong {
    struct texture_ref diffuse, specular, exponent, r0;
};

struct blinnphong_data {
    struct glossy glossy;
    spectrum diffuse, specular;
    double exponent, r0;
};

static const struct param params[] = {
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct blinnphong, diffuse), .def = "0.5",
     .max = 1, .unit = "", .help = "reflectance kd of the base"},
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct blinnphong, specular), .def = "0.2",
     .max = 1, .unit = "", .help = "reflectance ks of the facets at grazing incidence"},
    {"exponent", PARAM_TEXTURE_SCALAR, offsetof(struct blinnphong, exponent), .def = "30",
     .max = 1e8, .unit = "", .help = "the greater, the sharper the highlight"},
    {"r0", PARAM_TEXTURE_SCALAR, offsetof(struct blinnphong, r0), .def = "1", .max = 1, .unit = "",
     .help = "share of ks at normal incidence, rising to 1 (Schlick); 1: no Fresnel effect"},
    PARAM_END,
};

static uint32_t lobes(const void *data) {
    (void)data;
    return LOBE_DIFFUSE | LOBE_GLOSSY | LOBE_REFLECTION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct blinnphong *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    spectrum diffuse = texture_eval(&self->diffuse, &point->at);
    spectrum specular = texture_eval(&self->specular, &point->at);
    const float r0 = clampf(texture_eval_scalar(&self->r0, &point->at), 0, 1);
    glossy_limit(&diffuse, &specular);
    const float F = maxf((float)schlick_fresnel((double)wo[2], (double)r0), 0.02f);
    struct blinnphong_data *c = glossy_alloc(stack, &bsdf_blinnphong, sizeof *c, wo, diffuse,
                                             specular * F, LOBE_GLOSSY | LOBE_REFLECTION);
    if (!c)
        return NULL;
    c->diffuse = diffuse;
    c->specular = specular;
    c->exponent = (double)clampf(texture_eval_scalar(&self->exponent, &point->at), 0, 1e8f);
    c->r0 = (double)r0;
    return &c->glossy.head;
}

static struct glossy_value blinnphong_eval(const struct glossy *g, struct direction wi) {
    const struct blinnphong_data *c = (const void *)g;
    struct half_vector v;
    struct glossy_value value = {.base = c->diffuse};
    if (!half_vector_make(g->wo, wi, &v))
        return value;
    const double F = schlick_fresnel(v.cos_d, c->r0), D = blinn_phong_D(v.cos_h, c->exponent);
    value.f_cos = c->specular * (float)(F * D * v_cavity(&v) / (4 * v.cos_o));
    value.pdf_sa = half_vector_pdf(&v, D * v.cos_h);
    return value;
}

static bool blinnphong_sample(const struct glossy *g, double u1, struct vec2 u2,
                              struct direction *wi) {
    const struct blinnphong_data *c = (const void *)g;
    const struct direction h = blinn_phong_sample(c->exponent, (double)u2.x, (double)u2.y);
    *wi = half_vector_reflect(g->wo, h, u1);
    return true;
}

GLOSSY_FUNCTIONS(blinnphong)

static spectrum albedo(const struct closure *closure) {
    const struct blinnphong_data *c = (const void *)closure;
    return c->diffuse + c->specular * (float)schlick_fresnel(c->glossy.wo.z, c->r0);
}

const struct bsdf_type bsdf_blinnphong = {
    .entry = {.name = "blinnphong",
              .help = "Blinn-Phong microfacets over a diffuse base (Blinn 1977; Torrance and "
                      "Sparrow 1967)",
              .params = params, .size = sizeof(struct blinnphong)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample, .albedo = albedo,
};
