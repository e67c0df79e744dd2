// SPDX-License-Identifier: Apache-2.0
// Ashikhmin and Shirley's anisotropic Phong model over its diffuse base; formulas and source in
// math/ashikhmin_shirley.h.
#include "math/ashikhmin_shirley.h"

#include "bsdf/glossy.h"

struct ashikhminshirley {
    struct texture_ref diffuse, specular, exponent_u, exponent_v;
};

struct ashikhminshirley_data {
    struct glossy glossy;
    spectrum diffuse; // Rd (1 - Rs)
    spectrum specular;
    double nu, nv;
};

static const struct param params[] = {
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct ashikhminshirley, diffuse),
     .def = "0.5", .max = 1, .unit = "", .help = "reflectance Rd of the base"},
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct ashikhminshirley, specular),
     .def = "0.2", .max = 1, .unit = "",
     .help = "reflectance Rs at normal incidence, rising to 1 (Schlick)"},
    {"exponent_u", PARAM_TEXTURE_SCALAR, offsetof(struct ashikhminshirley, exponent_u),
     .def = "30", .max = 1e8, .unit = "", .help = "sharpness along the tangent"},
    {"exponent_v", PARAM_TEXTURE_SCALAR, offsetof(struct ashikhminshirley, exponent_v),
     .def = "30", .max = 1e8, .unit = "", .help = "sharpness along the bitangent"},
    PARAM_END,
};

static uint32_t lobes(const void *data) {
    const struct ashikhminshirley *self = data;
    const bool round = !self->exponent_u.texture && !self->exponent_v.texture &&
                       self->exponent_u.value[0] == self->exponent_v.value[0];
    return LOBE_DIFFUSE | LOBE_GLOSSY | LOBE_REFLECTION | (round ? 0 : LOBE_ANISOTROPIC);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct ashikhminshirley *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    const spectrum specular = texture_eval(&self->specular, &point->at);
    const spectrum diffuse =
        texture_eval(&self->diffuse, &point->at) * (spectrum_grey(1) - specular);
    const float w = (float)schlick_weight((double)wo[2]);
    const float base = 1 - (float)schlick_weight(0.5 * (double)wo[2]);
    const spectrum F = specular + (spectrum_grey(1) - specular) * maxf(w, 0.02f);
    struct ashikhminshirley_data *c =
        glossy_alloc(stack, &bsdf_ashikhminshirley, sizeof *c, wo, diffuse * base, F,
                     LOBE_GLOSSY | LOBE_REFLECTION);
    if (!c)
        return NULL;
    c->diffuse = diffuse;
    c->specular = specular;
    c->nu = (double)clampf(texture_eval_scalar(&self->exponent_u, &point->at), 0, 1e8f);
    c->nv = (double)clampf(texture_eval_scalar(&self->exponent_v, &point->at), 0, 1e8f);
    return &c->glossy.head;
}

static struct glossy_value ashikhminshirley_eval(const struct glossy *g, struct direction wi) {
    const struct ashikhminshirley_data *c = (const void *)g;
    struct half_vector v;
    struct glossy_value value = {
        .base = c->diffuse * (float)(M_PI * ashikhmin_shirley_base(g->wo.z, wi.z))};
    if (!half_vector_make(g->wo, wi, &v))
        return value;
    const double D = ashikhmin_shirley_D(v.h, c->nu, c->nv);
    const float w = (float)schlick_weight(v.cos_d);
    const spectrum F = c->specular + (spectrum_grey(1) - c->specular) * w;
    value.f_cos = F * (float)(D * v.cos_i / (4 * v.cos_d * fmax(v.cos_o, v.cos_i)));
    value.pdf_sa = half_vector_pdf(&v, D);
    return value;
}

static bool ashikhminshirley_sample(const struct glossy *g, double u1, struct vec2 u2,
                                    struct direction *wi) {
    const struct ashikhminshirley_data *c = (const void *)g;
    const struct direction h =
        ashikhmin_shirley_sample(c->nu, c->nv, (double)u2.x, (double)u2.y);
    *wi = half_vector_reflect(g->wo, h, u1);
    return true;
}

GLOSSY_FUNCTIONS(ashikhminshirley)

static spectrum albedo(const struct closure *closure) {
    const struct ashikhminshirley_data *c = (const void *)closure;
    const float w = (float)schlick_weight(c->glossy.wo.z);
    const float base = 1 - (float)schlick_weight(0.5 * c->glossy.wo.z);
    return c->diffuse * base + c->specular + (spectrum_grey(1) - c->specular) * w;
}

const struct bsdf_type bsdf_ashikhminshirley = {
    .entry = {.name = "ashikhminshirley",
              .help = "anisotropic Phong model (Ashikhmin and Shirley 2000)", .params = params,
              .size = sizeof(struct ashikhminshirley)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample, .albedo = albedo,
};
