// SPDX-License-Identifier: Apache-2.0
// A linear mixture of two materials.
#include "bsdf/bsdf.h"

struct blend {
    struct texture_ref weight;
    const struct object *child[2];
};

struct blend_data {
    struct closure head;
    const struct closure *child[2]; // NULL: black
    float weight[2];
};

static const struct param params[] = {
    {"weight", PARAM_TEXTURE_SCALAR, offsetof(struct blend, weight), .def = "0.5", .max = 1,
     .unit = "", .help = "share of the second material"},
    {"bsdf_0", PARAM_BSDF, offsetof(struct blend, child[0]), .unit = "",
     .help = "the first material"},
    {"bsdf_1", PARAM_BSDF, offsetof(struct blend, child[1]), .unit = "",
     .help = "the second material"},
    PARAM_END,
};

static bool prepare(struct object *self, struct arena *arena) {
    (void)arena;
    return bsdf_check_nesting(self);
}

static uint32_t lobes(const void *data) {
    const struct blend *self = data;
    return bsdf_lobes(self->child[0]) | bsdf_lobes(self->child[1]);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct blend *self = data;
    const float w = clampf(texture_eval_scalar(&self->weight, &point->at), 0, 1);
    if (w == 0 || w == 1)
        return bsdf_resolve(self->child[w == 1], point, wo, stack);
    const struct closure *a = bsdf_resolve(self->child[0], point, wo, stack);
    const struct closure *b = bsdf_resolve(self->child[1], point, wo, stack);
    if (!a && !b)
        return NULL;
    struct blend_data *c = closure_alloc(stack, &bsdf_blendbsdf, sizeof *c,
                                         (a ? a->lobes : 0) | (b ? b->lobes : 0));
    c->child[0] = a;
    c->child[1] = b;
    c->weight[0] = 1 - w;
    c->weight[1] = w;
    return &c->head;
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct blend_data *c = (const void *)closure;
    spectrum f = spectrum_grey(0);
    *pdf_sa = 0;
    for (int i = 0; i < 2; i++) {
        float pdf;
        if (!c->child[i])
            continue;
        f += c->weight[i] * closure_eval(c->child[i], wi, &pdf);
        *pdf_sa += c->weight[i] * pdf;
    }
    return f;
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct blend_data *c = (const void *)closure;
    const int i = u1 < c->weight[1];
    const float u = i ? u1 / c->weight[1] : (u1 - c->weight[1]) / c->weight[0];
    if (!c->child[i] || !closure_sample(c->child[i], minf(u, 0x1.fffffep-1f), u2, s))
        return false;
    const float own = s->pdf_sa * c->weight[i];
    if (s->lobe & LOBE_DELTA) {
        s->pdf_sa = own;
        return true;
    }
    float pdf = 0;
    const spectrum other = c->child[!i] ? closure_eval(c->child[!i], s->wi, &pdf) : spectrum_grey(0);
    const float total = own + c->weight[!i] * pdf;
    s->weight = s->weight * (own / total) + other * (c->weight[!i] / total);
    s->pdf_sa = total;
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct blend_data *c = (const void *)closure;
    spectrum sum = spectrum_grey(0);
    for (int i = 0; i < 2; i++)
        if (c->child[i])
            sum += c->weight[i] * closure_albedo(c->child[i]);
    return sum;
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    const struct blend *self = data;
    const float w = clampf(texture_eval_scalar(&self->weight, &point->at), 0, 1);
    return (1 - w) * bsdf_null_transmittance(self->child[0], point, wo) +
           w * bsdf_null_transmittance(self->child[1], point, wo);
}

static const char *const aliases[] = {"blend", NULL};

const struct bsdf_type bsdf_blendbsdf = {
    .entry = {.name = "blendbsdf", .help = "mixture of two materials", .aliases = aliases,
              .params = params, .size = sizeof(struct blend)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo, .null_transmittance = null_transmittance,
};
