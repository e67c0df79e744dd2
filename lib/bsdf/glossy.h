// SPDX-License-Identifier: Apache-2.0
// What the classic models share: a glossy part over a Lambertian base, computed in double precision
// from the formulas in math/, so that exponents of 1e7 and directions at the horizon keep their
// digits. A model is a pair of functions on its closure, which starts with a struct glossy.
//
// Conventions: a model sees the side of wo as the upper one.
#pragma once

#include "bsdf/bsdf.h"
#include "math/direction.h"
#include "math/warp.h"

// Directions nearer to the horizon than this are taken as that near (89.99999 degrees), and
// surfaces smoother than this as that smooth: a direction in single precision says no more.
#define GLOSSY_COS_MIN 1e-7
#define GLOSSY_ROUGHNESS_MIN 1e-4f

struct glossy {
    struct closure head;
    struct direction wo;
    float side;     // -1: wo is below
    float p_base;   // probability of sampling the base
};

// Of one direction wi, not on the horizon.
struct glossy_value {
    spectrum f_cos; // of the glossy part
    spectrum base;  // reflectance of the base, pi f
    double pdf_sa;  // of the glossy part's sample
};

typedef struct glossy_value (*glossy_eval_fn)(const struct glossy *g, struct direction wi);
// u1 is what is left of it after the base was not chosen. false: nothing was scattered.
typedef bool (*glossy_sample_fn)(const struct glossy *g, double u1, struct vec2 u2,
                                 struct direction *wi);

// A closure of `size` bytes whose first member is a struct glossy. `base` and `gloss` estimate what
// each part reflects towards wo. NULL where both are nothing.
static inline void *glossy_alloc(struct closure_stack *stack, const struct bsdf_type *type,
                                 size_t size, vec3 wo, spectrum base, spectrum gloss,
                                 uint32_t glossy_lobes) {
    const float b = spectrum_mean(base), g = spectrum_mean(gloss);
    if (!(b + g > 0))
        return NULL;
    const uint32_t lobes = (b > 0 ? LOBE_DIFFUSE | LOBE_REFLECTION : 0) |
                           (g > 0 ? glossy_lobes : 0);
    struct glossy *c = closure_alloc(stack, type, size, lobes);
    c->side = wo[2] < 0 ? -1 : 1;
    wo[2] = maxf(fabsf(wo[2]), (float)GLOSSY_COS_MIN);
    c->wo = direction_from(wo);
    c->p_base = b / (b + g);
    return c;
}

// Scales both parts alike where their sum exceeds 1 in a channel.
static inline void glossy_limit(spectrum *base, spectrum *gloss) {
    const float scale = 1 / maxf(1, spectrum_max(*base + *gloss));
    *base = *base * scale;
    *gloss = *gloss * scale;
}

// f |cos_i| and density of both parts together.
static inline spectrum glossy_total(const struct glossy *g, struct direction wi,
                                    glossy_eval_fn eval, double *pdf_sa) {
    const struct glossy_value v = eval(g, wi);
    const double lambert = fmax(wi.z, 0) * (1 / M_PI);
    *pdf_sa = (1 - (double)g->p_base) * v.pdf_sa + (double)g->p_base * lambert;
    return v.f_cos + v.base * (float)lambert;
}

static inline spectrum glossy_eval(const struct closure *closure, vec3 wi, float *pdf_sa,
                                   glossy_eval_fn eval) {
    const struct glossy *g = (const void *)closure;
    wi[2] *= g->side;
    *pdf_sa = 0;
    if (wi[2] == 0 || (wi[2] < 0 && !(closure->lobes & LOBE_TRANSMISSION)))
        return spectrum_grey(0);
    double pdf;
    const spectrum f = glossy_total(g, direction_from(wi), eval, &pdf);
    *pdf_sa = (float)pdf;
    return f;
}

static inline bool glossy_sample(const struct closure *closure, float u1, struct vec2 u2,
                                 struct bsdf_sample *s, glossy_eval_fn eval,
                                 glossy_sample_fn sample) {
    const struct glossy *g = (const void *)closure;
    struct direction wi;
    const bool base = u1 < g->p_base;
    if (base)
        wi = direction_from(warp_cosine_hemisphere(u2));
    else if (!sample(g, (double)(u1 - g->p_base) / (1 - (double)g->p_base), u2, &wi))
        return false;
    s->wi = direction_round(wi);
    if (s->wi[2] == 0 || (s->wi[2] < 0 && !(closure->lobes & LOBE_TRANSMISSION)))
        return false; // below the surface
    double pdf;
    const spectrum f = glossy_total(g, wi, eval, &pdf);
    s->pdf_sa = (float)pdf;
    s->weight = f / s->pdf_sa;
    s->weight[3] = 0;
    s->eta = 1;
    s->lobe = base ? LOBE_DIFFUSE | LOBE_REFLECTION
                   : LOBE_GLOSSY | (s->wi[2] > 0 ? LOBE_REFLECTION : LOBE_TRANSMISSION);
    s->wi[2] *= g->side;
    return s->pdf_sa > 0;
}

// The two entries of a bsdf_type for a model's functions model_eval and model_sample.
#define GLOSSY_FUNCTIONS(model)                                                                    \
    static spectrum eval(const struct closure *c, vec3 wi, float *pdf_sa) {                        \
        return glossy_eval(c, wi, pdf_sa, model##_eval);                                           \
    }                                                                                              \
    static bool sample(const struct closure *c, float u1, struct vec2 u2, struct bsdf_sample *s) { \
        return glossy_sample(c, u1, u2, s, model##_eval, model##_sample);                          \
    }
