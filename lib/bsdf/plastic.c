// SPDX-License-Identifier: Apache-2.0
// Diffuse base under a smooth dielectric coat. Light that the coat reflects back inside meets the
// base again; `nonlinear` colours it by the base each time, else only once.
#include "bsdf/smooth.h"
#include "math/fresnel.h"
#include "math/warp.h"

struct plastic {
    struct dielectric_index index;
    struct texture_ref diffuse, specular;
    bool nonlinear;
    struct plastic_coat coat;
};

struct plastic_data {
    struct closure head;
    vec3 reflected;
    spectrum specular; // F(wo) times the reflectance
    spectrum diffuse;  // f / (1 - F(wi)), times pi
    float eta;
    float p_specular;  // probability of the mirror direction
    float entering;    // of diffuse light
};

static const struct param params[] = {
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct plastic, diffuse), .def = "0.5",
     .max = 1, .unit = "", .help = "reflectance of the base"},
    {"nonlinear", PARAM_BOOL, offsetof(struct plastic, nonlinear), .def = "false", .unit = "",
     .help = "colours shift by scattering inside"},
    DIELECTRIC_INDEX_PARAMS(struct plastic, index, "polypropylene"),
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct plastic, specular), .def = "1",
     .max = 1, .unit = "", .help = "factor on the coat's reflection"},
    PARAM_END,
};

const struct closure *plastic_closure(const struct plastic_coat *coat, spectrum diffuse,
                                      spectrum specular, vec3 wo, struct closure_stack *stack) {
    struct plastic_data *c = closure_alloc(stack, &bsdf_plastic, sizeof *c,
                                           LOBE_SPECULAR | LOBE_DIFFUSE | LOBE_REFLECTION);
    float cos_t;
    const float F = fresnel_dielectric(cos_theta(wo), coat->eta, &cos_t);
    c->reflected = v3(-wo[0], -wo[1], wo[2]);
    c->specular = F * specular;
    c->diffuse = plastic_base(diffuse, coat) * (1 - F);
    c->eta = coat->eta;
    c->entering = coat->entering;
    const float s = spectrum_mean(c->specular), d = spectrum_mean(c->diffuse) * c->entering;
    c->p_specular = s + d > 0 ? s / (s + d) : 0;
    return &c->head;
}

static bool prepare(struct object *self, struct arena *arena) {
    struct plastic *p = self->data;
    const float eta = p->index.int_ior / p->index.ext_ior;
    (void)arena;
    p->coat = (struct plastic_coat){eta, (float)fresnel_dielectric_transmitted(eta),
                                    (float)fresnel_dielectric_transmitted(1.0 / eta),
                                    p->nonlinear};
    return true;
}

static uint32_t lobes(const void *data) {
    (void)data;
    return LOBE_SPECULAR | LOBE_DIFFUSE | LOBE_REFLECTION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct plastic *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    return plastic_closure(&self->coat, texture_eval(&self->diffuse, &point->at),
                           texture_eval(&self->specular, &point->at), wo, stack);
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct plastic_data *c = (const void *)closure;
    const float cos_i = cos_theta(wi);
    if (!(cos_i > 0)) {
        *pdf_sa = 0;
        return spectrum_grey(0);
    }
    float cos_t;
    *pdf_sa = (1 - c->p_specular) * cos_i * INV_PI;
    return c->diffuse * ((1 - fresnel_dielectric(cos_i, c->eta, &cos_t)) * cos_i * INV_PI);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct plastic_data *c = (const void *)closure;
    if (u1 < c->p_specular) {
        *s = (struct bsdf_sample){c->reflected, c->specular / c->p_specular, c->p_specular, 1,
                                  LOBE_SPECULAR | LOBE_REFLECTION};
        return true;
    }
    float cos_t;
    s->wi = warp_cosine_hemisphere(u2);
    const float T = 1 - fresnel_dielectric(cos_theta(s->wi), c->eta, &cos_t);
    s->pdf_sa = (1 - c->p_specular) * cos_theta(s->wi) * INV_PI;
    s->weight = c->diffuse * (T / (1 - c->p_specular));
    s->eta = 1;
    s->lobe = LOBE_DIFFUSE | LOBE_REFLECTION;
    return s->pdf_sa > 0;
}

static spectrum albedo(const struct closure *closure) {
    const struct plastic_data *c = (const void *)closure;
    return c->specular + c->diffuse * c->entering;
}

const struct bsdf_type bsdf_plastic = {
    .entry = {.name = "plastic", .help = "diffuse base under a smooth coat", .params = params,
              .size = sizeof(struct plastic)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
