// SPDX-License-Identifier: Apache-2.0
#include "integrator/symbolic_terms.h"

#include <assert.h>
#include <string.h>

#include "math/warp.h"

struct terms_closure {
    struct closure head;
    const struct symbolic *self;
    const struct symbolic_object *object;
    const struct closure *inside; // the material as it is
    struct chain *chain;
    struct direction wo;
    spectrum texture[FORM_TERMS];
    bool below; // the eye is on the other side
};

static void add_mark(struct marks *m, uint32_t index, spectrum weight) {
    uint32_t i = 0;
    while (i < m->count && m->mark[i].index != index)
        i++;
    assert(i < CHAIN_MARKS);
    if (i == m->count)
        m->mark[m->count++] = (struct mark){index, spectrum_grey(0)};
    m->mark[i].weight += weight;
}

// A term over its factor as it was; where it was black, over a curve that is 1.
static spectrum term_value(const struct terms_closure *c, uint32_t t, struct angles *a) {
    const struct symbolic_object *o = c->object;
    const struct form_term *term = &o->form->term[t];
    const bool keeps = !spectrum_is_black(o->part[t]);
    double v[CURVE_CHANNELS];
    if (keeps)
        form_term_eval(o->form, term, a, v);
    else
        quotient_cos(&term->quotient, a, v);
    const spectrum f = spectrum_clamp(spectrum_rgb((float)v[0], (float)v[1], (float)v[2]), 0, 1e30f);
    return c->texture[t] * f * (keeps ? o->part[t] : spectrum_grey(1));
}

// Leaves the marks of a direction that was drawn with that density. Not inlined, as in symbolic.c.
__attribute__((noinline)) static void mark_terms(const struct terms_closure *c, vec3 local, float pdf,
                                                 enum chain_way way) {
    const struct symbolic *self = c->self;
    const struct marks *met = &c->chain->met;
    struct marks *to = &c->chain->later[way];
    if (c->below)
        local[2] = -local[2];
    struct angles a = angles_between(c->wo, direction_from(local));
    to->count = 0;
    for (uint32_t t = 0; t < c->object->form->terms && pdf > 0; t++) {
        const spectrum value = term_value(c, t, &a) * (1 / pdf);
        for (uint32_t i = 0; i < met->count && !spectrum_is_black(value); i++)
            add_mark(to, self->next[met->mark[i].index * self->factors + c->object->factor + t],
                     met->mark[i].weight * value);
    }
}

// Where a term has no shape to keep, half of the directions are for it.
static float terms_pdf(const struct terms_closure *c, vec3 wi) {
    float pdf;
    closure_eval(c->inside, wi, &pdf);
    return c->object->lacks ? 0.5f * (pdf + fabsf(wi[2]) * INV_PI) : pdf;
}

static spectrum terms_eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct terms_closure *c = (const void *)closure;
    const bool above = (c->below ? -wi[2] : wi[2]) > 0;
    *pdf_sa = above ? terms_pdf(c, wi) : 0;
    mark_terms(c, wi, *pdf_sa, CHAIN_LIGHT);
    return spectrum_grey(*pdf_sa);
}

static bool terms_sample(const struct closure *closure, float u1, struct vec2 u2,
                         struct bsdf_sample *s) {
    const struct terms_closure *c = (const void *)closure;
    const bool even = c->object->lacks && u1 < 0.5f;
    if (even) {
        *s = (struct bsdf_sample){.wi = warp_cosine_hemisphere(u2)};
        if (c->below)
            s->wi[2] = -s->wi[2];
    } else if (!closure_sample(c->inside, c->object->lacks ? 2 * u1 - 1 : u1, u2, s)) {
        return false;
    }
    if (!((c->below ? -s->wi[2] : s->wi[2]) > 0))
        return false;
    if (c->object->lacks)
        s->pdf_sa = terms_pdf(c, s->wi);
    mark_terms(c, s->wi, s->pdf_sa, CHAIN_PATH);
    s->weight = spectrum_grey(1);
    s->eta = 1;
    s->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    return s->pdf_sa > 0 && c->chain->later[CHAIN_PATH].count > 0;
}

static const struct bsdf_type terms_type = {.entry = {.name = "terms"}, .eval = terms_eval,
                                            .sample = terms_sample};

const struct closure *symbolic_resolve_terms(const struct symbolic *self, struct chain *chain,
                                             const struct symbolic_object *o, const struct surface *s,
                                             vec3 wo, struct closure_stack *stack) {
    const struct closure *inside = bsdf_resolve(s->bsdf, &s->point, wo, stack);
    if (!inside)
        return NULL;
    struct terms_closure *c = closure_alloc(stack, &terms_type, sizeof *c,
                                            LOBE_GLOSSY | LOBE_REFLECTION);
    c->self = self;
    c->object = o;
    c->inside = inside;
    c->chain = chain;
    c->below = cos_theta(wo) < 0;
    if (c->below)
        wo[2] = -wo[2];
    c->wo = direction_from(wo);
    for (uint32_t t = 0; t < o->form->terms; t++)
        c->texture[t] = o->texture[t] ? texture_eval(o->texture[t], &s->point.at) : spectrum_grey(1);
    const struct marks *m = &chain->later[CHAIN_PATH];
    chain->met.count = m->count;
    memcpy(chain->met.mark, m->mark, m->count * sizeof *m->mark);
    chain->later_of_light = CHAIN_LIGHT;
    return &c->head;
}
