// SPDX-License-Identifier: Apache-2.0
// A material in the editable form: terms with tabulated curves, generated from a model, read from
// files, or edited by operators (curve/model.h, curve/curve.h, curve/operators.h).
//
// Terms are chosen in proportion to what they reflect towards wo, as measured when the material is
// prepared; each is sampled from its own curves (bsdf/curve_sampler.h).
#include "bsdf/editable.h"

#include <string.h>

#include "bsdf/editable_albedo.h"
#include "bsdf/editable_data.h"

struct editable_closure {
    struct closure head;
    const struct editable *self;
    struct direction wo;
    spectrum texture[FORM_TERMS];
    spectrum factor[FORM_TERMS]; // f_q times textures
    float select[FORM_TERMS];    // sum to 1
};

static uint32_t lobes(const void *data) {
    const struct editable *self = data;
    return self->lobes;
}

// Curve values at a place.
static spectrum curve_value(const struct editable *self, uint32_t curve,
                            const struct curve_place *p) {
    const spectrum *v = self->values[curve];
    spectrum sum = spectrum_grey(0);
    for (uint32_t i = 0; i < p->count; i++)
        sum += v[p->index[i]] * (float)p->value[i];
    return sum;
}

static void find_place(const struct editable *self, const struct form_slot *slot,
                       struct angles *a, struct curve_place *p) {
    p->count = 0;
    if (slot->gamma.kind == GAMMA_NONE)
        return;
    const struct basis *b = &self->form.curve[slot->curve].f[0].table->basis;
    p->count = basis_at(b, gamma_at(&slot->gamma, a), p->index, p->value);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct editable *self = data;
    float total = 0;
    if (!(cos_theta(wo) > 0))
        return NULL;
    struct editable_closure *c = closure_alloc(stack, &bsdf_editable, sizeof *c, self->lobes);
    c->self = self;
    c->wo = direction_from(wo);
    for (uint32_t t = 0; t < self->form.terms; t++) {
        const double *s = self->form.term[t].scale;
        c->texture[t] = texture_eval(self->texture[t], &point->at);
        c->factor[t] = spectrum_rgb((float)s[0], (float)s[1], (float)s[2]) * c->texture[t];
        c->select[t] = spectrum_mean(c->factor[t] * editable_albedo(self, t, c->wo.z)) +
                       1e-3f * spectrum_mean(c->factor[t]);
        total += c->select[t];
    }
    for (uint32_t t = 0; t < self->form.terms && total > 0; t++)
        c->select[t] /= total;
    return total > 0 ? &c->head : NULL;
}

static uint32_t values(const struct editable_closure *c, struct angles *a,
                       struct editable_value out[FORM_TERMS]) {
    const struct form *f = &c->self->form;
    for (uint32_t t = 0; t < f->terms; t++) {
        double q[CURVE_CHANNELS];
        quotient_cos(&f->term[t].quotient, a, q);
        out[t].factor = c->factor[t] * spectrum_rgb((float)q[0], (float)q[1], (float)q[2]);
        for (int s = 0; s < SLOTS; s++)
            find_place(c->self, &f->term[t].slots[s], a, &out[t].place[s]);
    }
    return f->terms;
}

uint32_t editable_values(const struct closure *closure, vec3 wi,
                         struct editable_value out[FORM_TERMS]) {
    const struct editable_closure *c = (const void *)closure;
    if (!(cos_theta(wi) > 0))
        return 0;
    const struct direction i = direction_from(wi);
    struct angles a = angles_between(c->wo, i);
    return values(c, &a, out);
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct editable_closure *c = (const void *)closure;
    const struct form *f = &c->self->form;
    struct editable_value v[FORM_TERMS];
    spectrum sum = spectrum_grey(0);
    double pdf = 0;
    *pdf_sa = 0;
    if (!(cos_theta(wi) > 0))
        return sum;
    const struct direction i = direction_from(wi);
    struct angles a = angles_between(c->wo, i);
    for (uint32_t t = 0, n = values(c, &a, v); t < n; t++) {
        for (int s = 0; s < SLOTS; s++)
            if (f->term[t].slots[s].gamma.kind != GAMMA_NONE)
                v[t].factor *= curve_value(c->self, f->term[t].slots[s].curve, &v[t].place[s]);
        sum += v[t].factor;
        pdf += (double)c->select[t] * curve_sampler_pdf_sa(&c->self->sampler[t], c->wo, i, &a);
    }
    *pdf_sa = (float)fmin(pdf, 1e30);
    return spectrum_clamp(sum, 0, 1e30f);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct editable_closure *c = (const void *)closure;
    double u = (double)u1;
    uint32_t t = 0;
    while (t + 1 < c->self->form.terms && u >= (double)c->select[t])
        u -= (double)c->select[t++];
    u = c->select[t] > 0 ? fmin(u / (double)c->select[t], 1 - 0x1p-53) : 0;
    s->wi = direction_round(curve_sampler_sample(&c->self->sampler[t], c->wo, u, (double)u2.x,
                                                 (double)u2.y));
    const spectrum f = eval(closure, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false; // below the surface
    s->weight = f / s->pdf_sa;
    s->eta = 1;
    s->lobe = c->self->lobe[t];
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct editable_closure *c = (const void *)closure;
    spectrum sum = spectrum_grey(0);
    for (uint32_t t = 0; t < c->self->form.terms; t++)
        sum += c->factor[t] * editable_albedo(c->self, t, c->wo.z);
    return sum;
}

const struct form *editable_form(const struct object *material) {
    return material->type == &bsdf_editable.entry
               ? &((const struct editable *)material->data)->form : NULL;
}

const struct closure *editable_inside(const struct closure *c, vec3 *wi, float *factor) {
    while (c && c->type != &bsdf_editable)
        c = c->type->inside ? c->type->inside(c, wi, factor) : NULL;
    return c;
}

const void *editable_owner(const struct closure *closure) {
    return ((const struct editable_closure *)(const void *)closure)->self;
}

struct direction editable_wo(const struct closure *closure) {
    return ((const struct editable_closure *)(const void *)closure)->wo;
}

spectrum editable_texture_at(const struct closure *closure, uint32_t term) {
    return ((const struct editable_closure *)(const void *)closure)->texture[term];
}

const struct texture_ref *editable_texture(const struct object *material, uint32_t term) {
    return ((const struct editable *)material->data)->texture[term];
}

const struct bsdf_type bsdf_editable = {
    .entry = {.name = "editable", .help = "terms with editable curves (Ben-Artzi 2007)",
              .params = editable_params, .size = sizeof(struct editable)},
    .prepare = editable_prepare, .lobes = lobes, .resolve = resolve, .eval = eval,
    .sample = sample, .albedo = albedo,
};
