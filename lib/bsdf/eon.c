// SPDX-License-Identifier: Apache-2.0
// Rough diffuse surface that keeps energy, and its single scattering alone; formulas and sources in
// math/eon.h.
#include "math/eon.h"

#include "bsdf/rough_diffuse.h"

struct eon {
    struct texture_ref reflectance, roughness;
    bool multiple;
};

struct eon_data {
    struct rough_diffuse base;
    spectrum reflectance;
    spectrum multiple; // reflectance of multiple scattering
    double r;
};

static const struct param params[] = {
    {"reflectance", PARAM_TEXTURE, offsetof(struct eon, reflectance), .def = "0.5", .max = 1,
     .unit = "", .help = "reflectance of a facet"},
    {"roughness", PARAM_TEXTURE_SCALAR, offsetof(struct eon, roughness), .def = "0.5", .max = 1,
     .unit = "", .help = "0: Lambertian; near Oren and Nayar's sigma in radians"},
    {"multiple_scattering", PARAM_BOOL, offsetof(struct eon, multiple), .def = "true", .unit = "",
     .help = "false: single scattering alone, Fujii's improved Oren-Nayar model"},
    PARAM_END,
};

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct eon *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    const double r = (double)clampf(texture_eval_scalar(&self->roughness, &point->at), 0, 1);
    struct eon_data *c = rough_diffuse_alloc(stack, &bsdf_eon, sizeof *c, wo, r);
    c->r = r;
    c->reflectance = texture_eval(&self->reflectance, &point->at);
    const float E = (float)fujii_average(r); // eon_multiple_reflectance, channel by channel
    c->multiple = spectrum_grey(0);
    if (self->multiple)
        c->multiple = spectrum_divide(c->reflectance * c->reflectance * E,
                                      spectrum_grey(1) - c->reflectance * (1 - E));
    return &c->base.head;
}

static spectrum eon_f_pi(const struct rough_diffuse *base, struct direction wi) {
    const struct eon_data *c = (const void *)base;
    return c->reflectance * (float)fujii_brdf(base->wo, wi, c->r) +
           c->multiple * (float)eon_multiple(base->wo.z, wi.z, c->r);
}

ROUGH_DIFFUSE_FUNCTIONS(eon)

static spectrum albedo(const struct closure *closure) {
    const struct eon_data *c = (const void *)closure;
    const float E = (float)fujii_albedo(c->base.wo.z, c->r);
    return c->reflectance * E + c->multiple * (1 - E);
}

const struct bsdf_type bsdf_eon = {
    .entry = {.name = "eon",
              .help = "rough diffuse reflection that keeps energy (Portsmouth et al. 2024)",
              .params = params, .size = sizeof(struct eon)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample, .albedo = albedo,
};
