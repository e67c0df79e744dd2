// SPDX-License-Identifier: Apache-2.0
// A material that is only partly there: opacity is the share of light that meets it, the rest
// passes straight through.
#include "bsdf/bsdf.h"

struct mask {
    struct texture_ref opacity;
    const struct object *child;
};

struct mask_data {
    struct closure head;
    const struct closure *child; // NULL: black
    vec3 wo;
    float opacity;
};

static const struct param params[] = {
    {"opacity", PARAM_TEXTURE_SCALAR, offsetof(struct mask, opacity), .def = "0.5", .max = 1,
     .unit = "", .help = "share of the surface that is there"},
    {"bsdf", PARAM_BSDF, offsetof(struct mask, child), .unit = "",
     .help = "material of what is there"},
    PARAM_END,
};

static bool prepare(struct object *self, struct arena *arena) {
    (void)arena;
    return bsdf_check_nesting(self);
}

static uint32_t lobes(const void *data) {
    const struct mask *self = data;
    return bsdf_lobes(self->child) | LOBE_NULL | LOBE_TRANSMISSION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct mask *self = data;
    const float opacity = clampf(texture_eval_scalar(&self->opacity, &point->at), 0, 1);
    const struct closure *child = opacity > 0 ? bsdf_resolve(self->child, point, wo, stack) : NULL;
    if (opacity == 1)
        return child;
    struct mask_data *c = closure_alloc(stack, &bsdf_mask, sizeof *c,
                                        (child ? child->lobes : 0) | LOBE_NULL | LOBE_TRANSMISSION);
    c->child = child;
    c->wo = wo;
    c->opacity = opacity;
    return &c->head;
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct mask_data *c = (const void *)closure;
    *pdf_sa = 0;
    if (!c->child)
        return spectrum_grey(0);
    const spectrum f = closure_eval(c->child, wi, pdf_sa);
    *pdf_sa *= c->opacity;
    return f * c->opacity;
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct mask_data *c = (const void *)closure;
    if (u1 >= c->opacity) {
        *s = (struct bsdf_sample){-c->wo, spectrum_grey(1), 1 - c->opacity, 1,
                                  LOBE_NULL | LOBE_TRANSMISSION};
        return true;
    }
    const float u = minf(u1 / c->opacity, 0x1.fffffep-1f);
    if (!c->child || !closure_sample(c->child, u, u2, s))
        return false;
    s->pdf_sa *= c->opacity;
    return true;
}

static const struct closure *inside(const struct closure *closure, vec3 *wi, float *factor) {
    const struct mask_data *c = (const void *)closure;
    (void)wi;
    *factor *= c->opacity;
    return c->child;
}

static spectrum albedo(const struct closure *closure) {
    const struct mask_data *c = (const void *)closure;
    const spectrum through = spectrum_grey(1 - c->opacity);
    return c->child ? c->opacity * closure_albedo(c->child) + through : through;
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    const struct mask *self = data;
    const float opacity = clampf(texture_eval_scalar(&self->opacity, &point->at), 0, 1);
    return spectrum_grey(1 - opacity) + opacity * bsdf_null_transmittance(self->child, point, wo);
}

const struct bsdf_type bsdf_mask = {
    .entry = {.name = "mask", .help = "partly transparent material", .params = params,
              .size = sizeof(struct mask)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo, .inside = inside, .null_transmittance = null_transmittance,
};
