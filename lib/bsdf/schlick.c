// SPDX-License-Identifier: Apache-2.0
// Schlick's rational model over a diffuse base that gets what the facets do not reflect,
//
//     f = F (directional + share / pi) + (1 - F) kd / pi,    F = Schlick's, from r0 = ks
//
// formulas and source in math/schlick.h. Rough surfaces reflect more than arrives at grazing
// angles, since G masks less than the slopes of Z call for; so there is no energy claim.
#include "math/schlick.h"

#include "bsdf/glossy.h"

struct schlick {
    struct texture_ref diffuse, specular, roughness;
    float isotropy;
    struct schlick_azimuth azimuth; // made by prepare
};

struct schlick_data {
    struct glossy glossy;
    spectrum diffuse, specular;
    const struct schlick *self;
    double r, p;
};

static const struct param params[] = {
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct schlick, diffuse), .def = "0.5",
     .max = 1, .unit = "", .help = "reflectance kd of the base"},
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct schlick, specular), .def = "0.2",
     .max = 1, .unit = "", .help = "reflectance at normal incidence, rising to 1"},
    {"roughness", PARAM_TEXTURE_SCALAR, offsetof(struct schlick, roughness), .def = "0.1",
     .max = 1, .unit = "", .help = "r: 0 smooth, 1 diffuse; at least 1e-8 is taken"},
    {"isotropy", PARAM_FLOAT, offsetof(struct schlick, isotropy), .def = "1", .min = 1e-4, .max = 1,
     .unit = "", .help = "p: towards 0 the highlight is stretched along the bitangent"},
    PARAM_END,
};

static bool prepare(struct object *self, struct arena *arena) {
    struct schlick *s = self->data;
    (void)arena;
    s->azimuth = schlick_azimuth_make((double)s->isotropy);
    return true;
}

static uint32_t lobes(const void *data) {
    const struct schlick *self = data;
    return LOBE_DIFFUSE | LOBE_GLOSSY | LOBE_REFLECTION |
           (self->isotropy < 1 ? LOBE_ANISOTROPIC : 0);
}

static spectrum fresnel(const struct schlick_data *c, double cos_d) {
    return c->specular + (spectrum_grey(1) - c->specular) * (float)schlick_weight(cos_d);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct schlick *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    struct schlick_data d = {
        .diffuse = texture_eval(&self->diffuse, &point->at),
        .specular = texture_eval(&self->specular, &point->at),
        .self = self,
        .r = (double)clampf(texture_eval_scalar(&self->roughness, &point->at), 1e-8f, 1),
        .p = (double)self->isotropy,
    };
    const float G = (float)schlick_G((double)wo[2], d.r);
    const spectrum F = fresnel(&d, (double)wo[2]) + spectrum_grey(0.01f);
    struct schlick_data *c =
        glossy_alloc(stack, &bsdf_schlick, sizeof *c, wo,
                     F * (1 - G) + (spectrum_grey(1) - d.specular) * d.diffuse, F * G,
                     LOBE_GLOSSY | LOBE_REFLECTION);
    if (!c)
        return NULL;
    d.glossy = c->glossy;
    *c = d;
    return &c->glossy.head;
}

static struct glossy_value schlick_eval(const struct glossy *g, struct direction wi) {
    const struct schlick_data *c = (const void *)g;
    struct half_vector v;
    struct glossy_value value = {.base = c->diffuse};
    if (!half_vector_make(g->wo, wi, &v))
        return value;
    const spectrum F = fresnel(c, v.cos_d);
    const float share = (float)schlick_diffuse_share(v.cos_o, v.cos_i, c->r);
    value.base = F * share + (spectrum_grey(1) - F) * c->diffuse;
    value.f_cos = F * (float)(schlick_directional(&v, c->r, c->p) * v.cos_i);
    value.pdf_sa = half_vector_pdf(&v, schlick_pdf_h(v.h, c->r, c->p, &c->self->azimuth));
    return value;
}

static bool schlick_sample(const struct glossy *g, double u1, struct vec2 u2,
                           struct direction *wi) {
    const struct schlick_data *c = (const void *)g;
    const struct direction h =
        schlick_half_sample(c->r, &c->self->azimuth, (double)u2.x, (double)u2.y);
    *wi = half_vector_reflect(g->wo, h, u1);
    return true;
}

GLOSSY_FUNCTIONS(schlick)

static spectrum albedo(const struct closure *closure) {
    const struct schlick_data *c = (const void *)closure;
    const spectrum F = fresnel(c, c->glossy.wo.z);
    return F + (spectrum_grey(1) - F) * c->diffuse;
}

const struct bsdf_type bsdf_schlick = {
    .entry = {.name = "schlick",
              .help = "rational model of roughness and isotropy over a diffuse base (Schlick 1994)",
              .params = params, .size = sizeof(struct schlick)},
    .claims = CLAIM_RECIPROCAL,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
