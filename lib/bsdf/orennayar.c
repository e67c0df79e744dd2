// SPDX-License-Identifier: Apache-2.0
// Rough diffuse surface of V-shaped grooves, Oren and Nayar's model in full and in its short
// form; formulas and source in math/oren_nayar.h. With a reflectance of 1 the full form reflects
// up to 1.044 of what arrives at grazing angles (roughness 0.4), the short one up to 1.013: no
// energy claim; eon keeps energy.
//
// alpha is the roughness of a Beckmann surface, sqrt 2 times the slope's standard deviation, as in
// Mitsuba 0.5's roughdiffuse.
#include "math/oren_nayar.h"

#include "bsdf/rough_diffuse.h"

struct orennayar {
    struct texture_ref reflectance, alpha;
    bool use_fast_approx;
};

struct orennayar_data {
    struct rough_diffuse base;
    bool fast;
    spectrum reflectance;
    double sigma;
};

static const char *const aliases[] = {"roughdiffuse", NULL};

static const struct param params[] = {
    {"reflectance", PARAM_TEXTURE, offsetof(struct orennayar, reflectance), .def = "0.5",
     .max = 1, .unit = "", .help = "reflectance of a facet"},
    {"alpha", PARAM_TEXTURE_SCALAR, offsetof(struct orennayar, alpha), .def = "0.2", .max = 10,
     .unit = "", .help = "roughness: standard deviation of the slope (radians) times sqrt 2"},
    {"use_fast_approx", PARAM_BOOL, offsetof(struct orennayar, use_fast_approx), .def = "false",
     .unit = "", .help = "the short form: without light that is reflected twice"},
    PARAM_END,
};

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct orennayar *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    const double sigma =
        (double)clampf(texture_eval_scalar(&self->alpha, &point->at), 0, 10) * M_SQRT1_2;
    struct orennayar_data *c =
        rough_diffuse_alloc(stack, &bsdf_orennayar, sizeof *c, wo, fmin(sigma, 1));
    c->fast = self->use_fast_approx;
    c->reflectance = texture_eval(&self->reflectance, &point->at);
    c->sigma = sigma;
    return &c->base.head;
}

static spectrum orennayar_f_pi(const struct rough_diffuse *base, struct direction wi) {
    const struct orennayar_data *c = (const void *)base;
    const struct oren_nayar_angles a = oren_nayar_angles(base->wo, wi);
    if (c->fast)
        return c->reflectance * (float)oren_nayar_qualitative(&a, c->sigma);
    return c->reflectance * (float)oren_nayar_once(&a, c->sigma) +
           c->reflectance * c->reflectance * (float)oren_nayar_twice(&a, c->sigma);
}

ROUGH_DIFFUSE_FUNCTIONS(orennayar)

static spectrum albedo(const struct closure *closure) {
    const struct orennayar_data *c = (const void *)closure;
    return c->reflectance * (float)fujii_albedo(c->base.wo.z, fmin(c->sigma, 1));
}

const struct bsdf_type bsdf_orennayar = {
    .entry = {.name = "orennayar", .aliases = aliases,
              .help = "rough diffuse reflection (Oren and Nayar 1994)", .params = params,
              .size = sizeof(struct orennayar)},
    .claims = CLAIM_RECIPROCAL,
    .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample, .albedo = albedo,
};
