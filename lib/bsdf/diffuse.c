// SPDX-License-Identifier: Apache-2.0
// Lambertian reflection: f = reflectance / pi on the side of the normal.
#include "bsdf/diffuse.h"

#include "math/warp.h"

struct diffuse_closure {
    struct closure head;
    spectrum reflectance;
};

static const struct param params[] = {
    {"reflectance", PARAM_TEXTURE, offsetof(struct diffuse, reflectance), .def = "0.5", .max = 1,
     .unit = "", .help = "share of the light that is reflected", .aka = "diffuse_reflectance"},
    PARAM_END,
};

static uint32_t lobes(const void *data) {
    (void)data;
    return LOBE_DIFFUSE | LOBE_REFLECTION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct diffuse *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    const spectrum reflectance = texture_eval(&self->reflectance, &point->at);
    if (spectrum_is_black(reflectance))
        return NULL;
    struct diffuse_closure *c =
        closure_alloc(stack, &bsdf_diffuse, sizeof *c, LOBE_DIFFUSE | LOBE_REFLECTION);
    c->reflectance = reflectance;
    return &c->head;
}

static bool widen(const void *data, struct wide_material *m) {
    const struct diffuse *self = data;
    m->kind = &diffuse_wide;
    m->data = self;
    m->textured = self->reflectance.texture != NULL;
    return true;
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct diffuse_closure *c = (const void *)closure;
    const float cos_i = cos_theta(wi);
    if (!(cos_i > 0)) {
        *pdf_sa = 0;
        return spectrum_grey(0);
    }
    *pdf_sa = cos_i * INV_PI;
    return c->reflectance * (cos_i * INV_PI);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct diffuse_closure *c = (const void *)closure;
    (void)u1;
    s->wi = warp_cosine_hemisphere(u2);
    s->pdf_sa = cos_theta(s->wi) * INV_PI;
    s->weight = c->reflectance;
    s->eta = 1;
    s->lobe = LOBE_DIFFUSE | LOBE_REFLECTION;
    return s->pdf_sa > 0;
}

static spectrum albedo(const struct closure *closure) {
    return ((const struct diffuse_closure *)(const void *)closure)->reflectance;
}

static struct diffuse white = {{{1, 1, 1, 0}, NULL}};

const struct object bsdf_white = {.type = &bsdf_diffuse.entry, .data = &white};

const struct bsdf_type bsdf_diffuse = {
    .entry = {.name = "diffuse", .help = "ideal diffuse reflection (Lambert 1760)",
              .params = params, .size = sizeof(struct diffuse)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample, .albedo = albedo,
    .widen = widen,
};
