// SPDX-License-Identifier: Apache-2.0
#include "integrator/symbolic.h"

#include "curve/arc.h"
#include "integrator/symbolic_terms.h"
#include "integrator/wide_basis.h"
#include "math/warp.h"

// ---- a surface with a basis -----------------------------------------------------------------

struct basis_closure {
    struct closure head;
    const struct symbolic_object *object;
    const struct bin_sampler *sampler;
    struct marks *to;           // [CHAIN_WAYS]
    const uint32_t *index;      // by place; NULL: the place itself
    spectrum texture[FORM_TERMS];
    struct bin_view view;
    bool below; // the eye is on the other side
};

struct axis {
    uint32_t count;
    uint32_t index[2];
    double value[2];
};

static struct axis axis_at(const struct form *f, const struct form_slot *slot, struct angles *a) {
    struct axis x = {1, {0}, {1}};
    if (slot->gamma.kind != GAMMA_NONE)
        x.count = basis_at(&f->curve[slot->curve].f[0].table->basis, gamma_at(&slot->gamma, a),
                           x.index, x.value);
    return x;
}

static void add_term(const struct basis_closure *c, uint32_t t, struct angles *a, float scale,
                     struct marks *m) {
    const struct symbolic_object *o = c->object;
    const struct form_term *term = &o->form->term[t];
    const struct axis x = axis_at(o->form, &term->slots[SLOT_A], a);
    const struct axis y = axis_at(o->form, &term->slots[SLOT_B], a);
    const uint32_t columns = symbolic_bins(o->form, t, SLOT_B);
    double q[CURVE_CHANNELS];
    quotient_cos(&term->quotient, a, q);
    const spectrum f = spectrum_clamp(spectrum_rgb((float)q[0], (float)q[1], (float)q[2]), 0, 1e30f);
    const spectrum weight = c->texture[t] * f * scale;
    if (spectrum_is_black(weight))
        return;
    for (uint32_t i = 0; i < x.count; i++)
        for (uint32_t j = 0; j < y.count; j++) {
            const uint32_t place = o->first[t] + x.index[i] * columns + y.index[j];
            m->mark[m->count++] = (struct mark){c->index ? c->index[place] : place,
                                                weight * (float)(x.value[i] * y.value[j])};
        }
}

// Leaves the marks of a direction in one of the lists and returns the density of drawing it. Not
// inlined: where it sees how wi was rounded, GCC 12 takes the vector that was there before.
__attribute__((noinline)) static float mark(const struct basis_closure *c, vec3 local,
                                            enum chain_way way) {
    const struct direction wi = direction_from(local);
    struct marks *m = &c->to[way];
    struct angles a = angles_between(c->view.wo, wi);
    const float pdf = (float)fmin(bin_sampler_pdf_sa(c->sampler, &c->view, wi, &a), 1e30);
    m->count = 0;
    for (uint32_t t = 0; t < c->object->form->terms && pdf > 0; t++)
        add_term(c, t, &a, 1 / pdf, m);
    return m->count ? pdf : 0;
}

static spectrum basis_eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct basis_closure *c = (const void *)closure;
    if (c->below)
        wi[2] = -wi[2];
    *pdf_sa = cos_theta(wi) > 0 ? mark(c, wi, CHAIN_LIGHT) : 0;
    return spectrum_grey(*pdf_sa);
}

static bool basis_sample(const struct closure *closure, float u1, struct vec2 u2,
                         struct bsdf_sample *s) {
    const struct basis_closure *c = (const void *)closure;
    const struct direction wi = bin_sampler_sample(c->sampler, &c->view, (double)u1,
                                                   (double)u2.x, (double)u2.y);
    s->wi = direction_round(wi);
    s->pdf_sa = cos_theta(s->wi) > 0 ? mark(c, s->wi, CHAIN_PATH) : 0;
    if (c->below)
        s->wi[2] = -s->wi[2];
    s->weight = spectrum_grey(1);
    s->eta = 1;
    s->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    return s->pdf_sa > 0;
}

static const struct bsdf_type basis_type = {.entry = {.name = "basis"}, .eval = basis_eval,
                                            .sample = basis_sample};

static const struct closure *resolve_basis(const struct symbolic_object *o, struct marks *to,
                                           const uint32_t *index, const struct surface *s, vec3 wo,
                                           struct closure_stack *stack) {
    struct basis_closure *c = closure_alloc(stack, &basis_type, sizeof *c,
                                            LOBE_GLOSSY | LOBE_REFLECTION);
    c->object = o;
    c->to = to;
    c->index = index;
    c->below = cos_theta(wo) < 0;
    if (c->below)
        wo[2] = -wo[2];
    c->sampler = index ? &o->coarse : &o->sampler;
    c->view = bin_sampler_view(c->sampler, direction_from(wo));
    for (uint32_t t = 0; t < o->form->terms; t++)
        c->texture[t] = o->texture[t] ? texture_eval(o->texture[t], &s->point.at) : spectrum_grey(1);
    return &c->head;
}

// ---- a surface with an albedo ---------------------------------------------------------------

struct white_closure {
    struct closure head;
    bool below;
};

static spectrum white_eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const float z = ((const struct white_closure *)(const void *)closure)->below ? -wi[2] : wi[2];
    *pdf_sa = z > 0 ? z * INV_PI : 0;
    return spectrum_grey(*pdf_sa);
}

static bool white_sample(const struct closure *closure, float u1, struct vec2 u2,
                         struct bsdf_sample *s) {
    (void)u1;
    s->wi = warp_cosine_hemisphere(u2);
    s->pdf_sa = s->wi[2] * INV_PI;
    if (((const struct white_closure *)(const void *)closure)->below)
        s->wi[2] = -s->wi[2];
    s->weight = spectrum_grey(1);
    s->eta = 1;
    s->lobe = LOBE_DIFFUSE | LOBE_REFLECTION;
    return s->pdf_sa > 0;
}

static const struct bsdf_type white_type = {.entry = {.name = "white"}, .eval = white_eval,
                                            .sample = white_sample};

static const struct closure *resolve_white(vec3 wo, struct closure_stack *stack) {
    struct white_closure *c = closure_alloc(stack, &white_type, sizeof *c,
                                            LOBE_DIFFUSE | LOBE_REFLECTION);
    c->below = cos_theta(wo) < 0;
    return &c->head;
}

// ---- the response ---------------------------------------------------------------------------

// Whether a later hop of an object has a basis of its own.
static bool is_second(const struct symbolic *self, const struct chain *chain, int object) {
    return self->objects[object].second && chain->later[CHAIN_PATH].mark[0].index == 0;
}

// Meets an object's albedo.
static void take_step(const struct symbolic *self, struct chain *chain, int object) {
    const struct symbolic_object *o = &self->objects[object];
    struct marks *m = &chain->later[CHAIN_PATH];
    for (uint32_t i = 0; i < m->count; i++) {
        m->mark[i].index = self->next[m->mark[i].index * self->factors + o->factor];
        m->mark[i].weight *= o->scale;
    }
}

static enum response_way way(const struct response *response, const struct trace_context *ctx,
                             int lane, uint32_t depth, uint32_t shape) {
    const struct symbolic *self = (const void *)response;
    const int object = self->object_of_shape[shape];
    if (object == CHAIN_FIXED)
        return self->survey ? RESPONSE_ALONE : RESPONSE_WORLD;
    const struct symbolic_object *o = &self->objects[object];
    if (self->survey || depth >= self->bounces)
        return RESPONSE_ALONE;
    if (depth == 0)
        return o->wide ? RESPONSE_OWN : RESPONSE_ALONE;
    return o->keeps || o->splits || is_second(self, &ctx->sink->chains[lane], object) ? RESPONSE_ALONE
                                                                         : RESPONSE_WORLD;
}

static const void *note(const struct response *response, const struct trace_context *ctx, int lane,
                        uint32_t depth, uint32_t shape) {
    const struct symbolic *self = (const void *)response;
    const int object = self->object_of_shape[shape];
    struct chain *chain = &ctx->sink->chains[lane];
    chain->first_of_light = chain->later_of_light = CHAIN_PATH;
    if (object != CHAIN_FIXED && depth > 0)
        take_step(self, chain, object);
    if (object == CHAIN_FIXED || depth > 0)
        return NULL;
    chain->object = object;
    chain->basis = &self->objects[object];
    chain->first_of_light = CHAIN_LIGHT;
    return chain;
}

// A surface met after others.
static const struct closure *resolve_later(const struct symbolic *self, struct chain *chain,
                                           int object, const struct surface *s, vec3 wo,
                                           struct closure_stack *stack) {
    const struct symbolic_object *o = &self->objects[object];
    if (is_second(self, chain, object)) {
        chain->later_of_light = CHAIN_LIGHT;
        return resolve_basis(o, chain->later, o->second, s, wo, stack);
    }
    if (o->splits)
        return symbolic_resolve_terms(self, chain, o, s, wo, stack);
    take_step(self, chain, object);
    return o->keeps ? bsdf_resolve(s->bsdf, &s->point, wo, stack) : resolve_white(wo, stack);
}

static const struct closure *resolve(const struct response *response,
                                     const struct trace_context *ctx, int lane, uint32_t depth,
                                     const struct surface *s, vec3 wo) {
    const struct symbolic *self = (const void *)response;
    struct chain *chain = &ctx->sink->chains[lane];
    const int object = self->object_of_shape[s->shape];
    const bool front = cos_theta(wo) > 0 || (self->two_sided[s->shape] && cos_theta(wo) < 0);
    chain->first_of_light = chain->later_of_light = CHAIN_PATH;
    if (self->survey && depth > 0)
        return NULL;
    if (object == CHAIN_FIXED || depth >= self->bounces)
        return bsdf_resolve(s->bsdf, &s->point, wo, ctx->stack);
    if (!front)
        return NULL;
    if (depth > 0)
        return resolve_later(self, chain, object, s, wo, ctx->stack);
    chain->object = object;
    if (self->survey) {
        if (self->objects[object].knows_view)
            chain->view = (float)arc_quarter(sqrt((double)wo[0] * (double)wo[0] +
                                                  (double)wo[1] * (double)wo[1]),
                                             fabs((double)wo[2]));
        return NULL;
    }
    chain->first_of_light = CHAIN_LIGHT;
    return resolve_basis(&self->objects[object], chain->first, NULL, s, wo, ctx->stack);
}

void symbolic_init(struct symbolic *s) {
    s->response = (struct response){resolve, way, &wide_basis, note};
}

void symbolic_object_ready(struct symbolic_object *o) {
    o->wide = wide_basis_fits(o);
}

void symbolic_object_init(struct symbolic_object *o, const struct form *form, struct arena *arena) {
    *o = (struct symbolic_object){.form = form};
    for (uint32_t t = 0; t + 1 < form->terms; t++)
        o->first[t + 1] = o->first[t] + symbolic_places(form, t);
    for (uint32_t t = 0; t < form->terms; t++)
        o->knows_view |= form->term[t].slots[SLOT_O].gamma.kind != GAMMA_NONE;
    bin_sampler_init(&o->sampler, form, arena);
}
