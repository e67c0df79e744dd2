// SPDX-License-Identifier: Apache-2.0
// No surface at all: light passes straight through.
#include "bsdf/bsdf.h"

struct null_data {
    struct closure head;
    vec3 wi;
};

static uint32_t lobes(const void *data) {
    (void)data;
    return LOBE_NULL | LOBE_TRANSMISSION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    (void)data;
    (void)point;
    struct null_data *c =
        closure_alloc(stack, &bsdf_null, sizeof *c, LOBE_NULL | LOBE_TRANSMISSION);
    c->wi = -wo;
    return &c->head;
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct null_data *c = (const void *)closure;
    (void)u1;
    (void)u2;
    *s = (struct bsdf_sample){c->wi, spectrum_grey(1), 1, 1, LOBE_NULL | LOBE_TRANSMISSION};
    return true;
}

static spectrum albedo(const struct closure *closure) {
    (void)closure;
    return spectrum_grey(1);
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    (void)data;
    (void)point;
    (void)wo;
    return spectrum_grey(1);
}

const struct bsdf_type bsdf_null = {
    .entry = {.name = "null", .help = "no surface", .size = 0},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY | CLAIM_LOSSLESS,
    .lobes = lobes, .resolve = resolve, .eval = closure_eval_delta, .sample = sample, .albedo = albedo,
    .null_transmittance = null_transmittance,
};
