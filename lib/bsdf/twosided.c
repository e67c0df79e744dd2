// SPDX-License-Identifier: Apache-2.0
// Gives one-sided materials a back: the same one mirrored, or a second one.
#include "bsdf/bsdf.h"

struct twosided {
    const struct object *front, *back; // back NULL: the front's
};

struct twosided_data {
    struct closure head;
    const struct closure *child; // of the mirrored directions
};

static const struct param params[] = {
    {"front", PARAM_BSDF, offsetof(struct twosided, front), .unit = "",
     .help = "material on the side of the normal"},
    {"back", PARAM_BSDF, offsetof(struct twosided, back), .unit = "", .optional = true,
     .help = "material on the other side (the first one, unless given)"},
    PARAM_END,
};

static uint32_t lobes(const void *data) {
    const struct twosided *self = data;
    return bsdf_lobes(self->front) | (self->back ? bsdf_lobes(self->back) : 0);
}

static bool prepare(struct object *self, struct arena *arena) {
    (void)arena;
    if (!bsdf_check_nesting(self))
        return false;
    if (lobes(self->data) & LOBE_TRANSMISSION) {
        log_error_at(self->at, "twosided: a material that transmits was found inside; expected one "
                     "that only reflects");
        return false;
    }
    return true;
}

static vec3 mirror(vec3 w) {
    return v3(w[0], w[1], -w[2]);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct twosided *self = data;
    if (cos_theta(wo) > 0)
        return bsdf_resolve(self->front, point, wo, stack);
    const struct closure *child =
        bsdf_resolve(self->back ? self->back : self->front, point, mirror(wo), stack);
    if (!child)
        return NULL;
    struct twosided_data *c = closure_alloc(stack, &bsdf_twosided, sizeof *c, child->lobes);
    c->child = child;
    return &c->head;
}

static bool widen(const void *data, struct wide_material *m) {
    const struct twosided *self = data;
    const bool can = !self->back && bsdf_wide(self->front, m);
    m->two_sided = true;
    return can;
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct twosided_data *c = (const void *)closure;
    return closure_eval(c->child, mirror(wi), pdf_sa);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct twosided_data *c = (const void *)closure;
    if (!closure_sample(c->child, u1, u2, s))
        return false;
    s->wi = mirror(s->wi);
    return true;
}

static const struct closure *inside(const struct closure *closure, vec3 *wi, float *factor) {
    (void)factor;
    *wi = mirror(*wi);
    return ((const struct twosided_data *)(const void *)closure)->child;
}

static spectrum albedo(const struct closure *closure) {
    const struct twosided_data *c = (const void *)closure;
    return closure_albedo(c->child);
}

const struct bsdf_type bsdf_twosided = {
    .entry = {.name = "twosided", .help = "one-sided materials on both sides", .params = params,
              .size = sizeof(struct twosided)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo, .widen = widen, .inside = inside,
};
