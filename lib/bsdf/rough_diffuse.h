// SPDX-License-Identifier: Apache-2.0
// What rough diffuse materials share: EON's lobe samples them all (math/eon.h). A model is a
// function that gives f pi for its closure, which starts with a struct rough_diffuse.
#pragma once

#include "bsdf/bsdf.h"
#include "math/eon.h"

struct rough_diffuse {
    struct closure head;
    struct direction wo;
    struct eon_lobe lobe;
};

typedef spectrum (*rough_diffuse_fn)(const struct rough_diffuse *c, struct direction wi);

// A closure of `size` bytes whose first member is a struct rough_diffuse; r in [0, 1]. Directions
// nearer to the horizon than 1e-7 are taken as that near.
static inline void *rough_diffuse_alloc(struct closure_stack *stack, const struct bsdf_type *type,
                                        size_t size, vec3 wo, double r) {
    struct rough_diffuse *c = closure_alloc(stack, type, size, LOBE_DIFFUSE | LOBE_REFLECTION);
    c->wo = direction_from(v3(wo[0], wo[1], maxf(wo[2], 1e-7f)));
    c->lobe = eon_lobe_make(c->wo, r);
    return c;
}

static inline spectrum rough_diffuse_eval(const struct closure *closure, vec3 wi, float *pdf_sa,
                                          rough_diffuse_fn f_pi) {
    const struct rough_diffuse *c = (const void *)closure;
    *pdf_sa = 0;
    if (!(wi[2] > 0))
        return spectrum_grey(0);
    const struct direction d = direction_from(wi);
    *pdf_sa = (float)eon_lobe_pdf(&c->lobe, d);
    return f_pi(c, d) * ((float)d.z * INV_PI);
}

static inline bool rough_diffuse_sample(const struct closure *closure, float u1, struct vec2 u2,
                                        struct bsdf_sample *s, rough_diffuse_fn f_pi) {
    const struct rough_diffuse *c = (const void *)closure;
    const struct direction d =
        eon_lobe_sample(&c->lobe, (double)u1, (double)u2.x, (double)u2.y);
    s->wi = direction_round(d);
    if (!(s->wi[2] > 0))
        return false;
    s->pdf_sa = (float)eon_lobe_pdf(&c->lobe, d);
    s->weight = f_pi(c, d) * ((float)d.z * INV_PI / s->pdf_sa);
    s->eta = 1;
    s->lobe = LOBE_DIFFUSE | LOBE_REFLECTION;
    return s->pdf_sa > 0;
}

// The functions of a bsdf_type for a model's function model_f_pi.
#define ROUGH_DIFFUSE_FUNCTIONS(model)                                                             \
    static uint32_t lobes(const void *data) {                                                      \
        (void)data;                                                                                \
        return LOBE_DIFFUSE | LOBE_REFLECTION;                                                     \
    }                                                                                              \
    static spectrum eval(const struct closure *c, vec3 wi, float *pdf_sa) {                        \
        return rough_diffuse_eval(c, wi, pdf_sa, model##_f_pi);                                    \
    }                                                                                              \
    static bool sample(const struct closure *c, float u1, struct vec2 u2, struct bsdf_sample *s) { \
        return rough_diffuse_sample(c, u1, u2, s, model##_f_pi);                                   \
    }
