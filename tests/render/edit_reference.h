// SPDX-License-Identifier: Apache-2.0
// For tests of editing tensors with bounces: the weights of an edited scene, a contraction that is
// plain to see, and a path tracer whose surfaces answer as the tensor's model of them says: with the
// material itself where the eye sees it, Lambertian with the equivalent albedo (or by a coarse curve)
// later; where terms have factors of their own (--later terms), with those of the scene as it was, each
// times the change of its factor. It draws directions as the symbolic response does and evaluates on its own.
#pragma once

#include "driver/precompute_polynomial.h"
#include "math/warp.h"
#include "render/picture.h"

enum { MOST_PLACES = 4096, MOST_FACTORS = 4096 };

// An edited scene: numbers that coefficients are multiplied by.
struct edited {
    struct polynomial p;
    struct response response; // of the reference
    bool flat;                // Lambertian where the eye sees it, too
    const struct edited *was; // the scene as it was, where terms have factors; or NULL
    double (*weights)[3];     // by object and place: f_q c_A c_B
    uint32_t first[64];   // of an object in `weights`
    double (*albedos)[3];     // by object, at later hops
    double (*factors)[3];
    double (*groups)[3];
};

// e_j as the tensor tells them.
static inline void told_albedo(const struct tensor *t, uint32_t object, uint32_t term, double *a) {
    const struct json *o = json_at(json_get(t->meta, "objects"), object);
    const struct json *list = json_get(
        json_at(json_get(json_get(o, "form"), "terms"), term), "albedo");
    for (size_t i = 0; i < json_count(list); i++)
        CHECK(json_read_number(json_at(list, i), &a[i]));
}

// classes: of the tensor's scene.
static inline void edited_factors(struct edited *e, const struct tensor *tensor,
                                  const struct edit_classes *classes) {
    const struct polynomial *p = &e->p;
    static float w[3 * MOST_PLACES];
    static double a[3 * MOST_PLACES], top[MOST_FACTORS][3], bottom[MOST_FACTORS][3];
    memset(top, 0, sizeof top);
    memset(bottom, 0, sizeof bottom);
    for (uint32_t i = 0; i < p->plan.count; i++) {
        const struct symbolic_object *o = &p->objects[i];
        for (uint32_t t = 0; t < o->form->terms; t++) {
            const uint32_t step = p->groups.step[i] + t;
            edit_plan_weights(&p->plan, i, t, w);
            told_albedo(tensor, i, t, a);
            for (uint32_t j = 0; j < symbolic_places(o->form, t); j++)
                for (uint32_t k = 0; k < 3; k++) {
                    const double c = (double)w[3 * j + k], ce = c * a[3 * j + k];
                    const uint32_t place = o->first[t] + j;
                    e->weights[e->first[i] + place][k] = c;
                    e->albedos[i][k] += p->plan.objects[i].share[t][k] * ce;
                    if (o->splits) {
                        top[step][k] += ce;
                        bottom[step][k] += a[3 * j + k];
                    }
                    if (!o->second)
                        continue;
                    const uint32_t f = p->groups.last[o->second[place]];
                    top[f][k] += ce;
                    bottom[f][k] += a[3 * j + k];
                }
        }
    }
    for (uint32_t i = 0; i < p->plan.count; i++)
        for (int k = 0; k < 3; k++)
            if (!p->objects[i].splits)
                e->factors[p->groups.step[i]][k] += classes->share[i][k] * e->albedos[i][k];
    for (uint32_t i = 0; i < p->plan.count; i++)
        for (int k = 0; k < 3; k++)
            if (!p->objects[i].splits)
                e->albedos[i][k] = classes->base[i][k] * e->factors[p->groups.step[i]][k];
    for (uint32_t f = 0; f < p->groups.factor_count; f++)
        for (int k = 0; k < 3 && p->groups.factors[f].term != EDIT_ALBEDO; k++)
            e->factors[f][k] = bottom[f][k] > 0 ? top[f][k] / bottom[f][k] : 0;
}

static inline void edited_groups(struct edited *e) {
    const struct edit_groups *g = &e->p.groups;
    for (uint32_t i = 0; i < g->count; i++) {
        uint32_t list[EDIT_MOST_BOUNCES];
        const uint32_t n = edit_group_factors(g, i, list);
        for (int k = 0; k < 3; k++) {
            e->groups[i][k] = 1;
            for (uint32_t f = 0; f < n; f++)
                e->groups[i][k] *= e->factors[list[f]][k];
        }
    }
}

// ---- the reference path tracer --------------------------------------------------------------

struct reference_closure {
    struct closure head;
    const struct edited *edited;
    const struct closure *inside; // of the material as it is; NULL: as below
    uint32_t object;
    const struct closure *shape; // of the material as it was, where its terms have factors
    bool coarse;
    bool below;
    const struct bin_sampler *sampler;
    struct bin_view view;
    spectrum texture[FORM_TERMS];
};

static inline spectrum coarse_value(const struct reference_closure *c, struct angles *a) {
    const struct edited *e = c->edited;
    const struct symbolic_object *o = &e->p.objects[c->object];
    double sum[3] = {0};
    for (uint32_t t = 0; t < o->form->terms; t++) {
        const struct form_term *term = &o->form->term[t];
        uint32_t x[2] = {0}, y[2] = {0}, m = 1, n = 1;
        double u[2] = {1}, v[2] = {1}, q[3];
        if (edit_term_has(term, SLOT_A))
            m = basis_at(edit_basis(o->form, &term->slots[SLOT_A]),
                         gamma_at(&term->slots[SLOT_A].gamma, a), x, u);
        if (edit_term_has(term, SLOT_B))
            n = basis_at(edit_basis(o->form, &term->slots[SLOT_B]),
                         gamma_at(&term->slots[SLOT_B].gamma, a), y, v);
        quotient_cos(&term->quotient, a, q);
        for (uint32_t i = 0; i < m; i++)
            for (uint32_t j = 0; j < n; j++)
                for (int k = 0; k < 3; k++) {
                    const uint32_t place =
                        o->first[t] + x[i] * symbolic_bins(o->form, t, SLOT_B) + y[j];
                    sum[k] += (double)c->texture[t][k] * q[k] * u[i] * v[j] *
                              e->factors[e->p.groups.last[o->second[place]]][k];
                }
    }
    return spectrum_rgb((float)sum[0], (float)sum[1], (float)sum[2]);
}

// Each term as it was times the change of its factor, or where it was black, all alike.
static inline spectrum terms_value(const struct reference_closure *c, struct angles *a) {
    const struct edited *e = c->edited, *was = e->was;
    const struct form *f = was->p.plan.objects[c->object].form;
    double sum[3] = {0};
    for (uint32_t t = 0; t < f->terms; t++) {
        const uint32_t step = e->p.groups.step[c->object] + t;
        const double *now = e->factors[step], *old = was->factors[step];
        const bool keeps = !spectrum_is_black(was->p.objects[c->object].part[t]);
        double v[3];
        if (keeps)
            form_term_eval(f, &f->term[t], a, v);
        else
            quotient_cos(&f->term[t].quotient, a, v);
        for (int k = 0; k < 3; k++)
            sum[k] += (double)c->texture[t][k] * v[k] *
                      (keeps ? f->term[t].scale[k] * now[k] / old[k] : now[k]);
    }
    return spectrum_rgb((float)sum[0], (float)sum[1], (float)sum[2]);
}

static inline float terms_pdf(const struct reference_closure *c, vec3 wi) {
    float pdf;
    closure_eval(c->shape, wi, &pdf);
    return c->edited->was->p.objects[c->object].lacks ? 0.5f * (pdf + fabsf(wi[2]) * INV_PI) : pdf;
}

static inline spectrum reference_eval(const struct closure *closure, vec3 wi, float *pdf) {
    const struct reference_closure *c = (const void *)closure;
    const struct edited *e = c->edited;
    const vec3 up = c->below ? v3(wi[0], wi[1], -wi[2]) : wi;
    *pdf = 0;
    if (!(up[2] > 0))
        return spectrum_grey(0);
    if (!c->inside && !c->coarse && !c->shape) {
        const double *d = e->albedos[c->object];
        *pdf = up[2] * INV_PI;
        return spectrum_rgb((float)d[0], (float)d[1], (float)d[2]) * *pdf;
    }
    const struct direction i = direction_from(up);
    struct angles a = angles_between(c->view.wo, i);
    float other;
    if (c->shape) {
        *pdf = terms_pdf(c, wi);
        return terms_value(c, &a);
    }
    *pdf = (float)bin_sampler_pdf_sa(c->sampler, &c->view, i, &a);
    return c->inside ? closure_eval(c->inside, wi, &other) : coarse_value(c, &a);
}

static inline bool reference_sample(const struct closure *closure, float u1, struct vec2 u2,
                                    struct bsdf_sample *s) {
    const struct reference_closure *c = (const void *)closure;
    const bool lacks = c->shape && c->edited->was->p.objects[c->object].lacks;
    if (c->shape && !(lacks && u1 < 0.5f)) {
        if (!closure_sample(c->shape, lacks ? 2 * u1 - 1 : u1, u2, s))
            return false;
        if (c->below)
            s->wi[2] = -s->wi[2];
    } else if (!c->inside && !c->coarse)
        s->wi = warp_cosine_hemisphere(u2);
    else
        s->wi = direction_round(bin_sampler_sample(c->sampler, &c->view, (double)u1, (double)u2.x,
                                                   (double)u2.y));
    if (!(s->wi[2] > 0))
        return false;
    if (c->below)
        s->wi[2] = -s->wi[2];
    const spectrum f = reference_eval(closure, s->wi, &s->pdf_sa);
    s->weight = f / s->pdf_sa;
    s->eta = 1;
    s->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    return s->pdf_sa > 0;
}

static const struct bsdf_type reference_type = {.entry = {.name = "reference"},
                                                .eval = reference_eval, .sample = reference_sample};

static inline const struct closure *reference_resolve(const struct response *self,
                                                      const struct trace_context *ctx, int lane,
                                                      uint32_t depth, const struct surface *s,
                                                      vec3 wo) {
    const struct edited *e = (const void *)((const char *)self - offsetof(struct edited, response));
    const int object = e->p.response.object_of_shape[s->shape];
    const struct closure *inside = bsdf_resolve(s->bsdf, &s->point, wo, ctx->stack);
    struct chain *chain = &ctx->sink->chains[lane]; // only its word on whether a hop is the second
    const bool first_later = depth == 0 || chain->object == 0;
    if (depth == 0)
        chain->object = 0;
    if (object == CHAIN_FIXED || depth >= e->p.response.bounces)
        return inside;
    if (!(wo[2] > 0) && !e->p.response.two_sided[s->shape])
        return NULL;
    struct reference_closure *c = closure_alloc(ctx->stack, &reference_type, sizeof *c,
                                                LOBE_GLOSSY | LOBE_REFLECTION);
    c->edited = e;
    c->object = (uint32_t)object;
    c->inside = depth == 0 && !e->flat ? inside : NULL;
    c->below = wo[2] < 0;
    c->shape = NULL;
    c->coarse = depth > 0 && first_later && e->p.objects[object].second;
    if (depth > 0 && !c->coarse && e->p.objects[object].splits)
        c->shape = bsdf_resolve(e->was->p.job.scene->shapes[s->shape].bsdf, &s->point, wo, ctx->stack);
    if (c->below)
        wo[2] = -wo[2];
    c->sampler = c->coarse ? &e->p.objects[object].coarse : &e->p.objects[object].sampler;
    c->view = bin_sampler_view(c->sampler, direction_from(wo));
    for (uint32_t t = 0; t < e->p.objects[object].form->terms; t++)
        c->texture[t] = texture_eval(e->p.objects[object].texture[t], &s->point.at);
    if (depth > 0)
        chain->object = 1;
    return &c->head;
}

// ---- a sink of pictures in double -----------------------------------------------------------

struct plain_sink {
    struct sink sink; // first
    struct tile_grid grid;
    int width, height;
    double *frame; // [3][pixel]
    struct sink_area wanted;
    double *pixel[SINK_MOST_LANES];
    double sum[SINK_MOST_LANES][3];
    struct chain chains[SINK_MOST_LANES];
};

static inline void plain_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct plain_sink *v = (void *)s;
    v->wanted = *wanted = tile_grid_area(&v->grid, tile);
}

static inline void plain_close(struct sink *s) {
    (void)s;
}

static inline void plain_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    struct plain_sink *v = (void *)s;
    (void)sample;
    v->pixel[lane] = sink_area_has(&v->wanted, x, y) ? v->frame + y * v->width + x : NULL;
}

static inline void plain_begin(struct sink *s, int lane) {
    struct plain_sink *v = (void *)s;
    v->sum[lane][0] = v->sum[lane][1] = v->sum[lane][2] = 0;
    chain_begin(&v->chains[lane]);
}

static inline void plain_add(struct sink *s, int lane, const struct contribution *c) {
    struct plain_sink *v = (void *)s;
    const spectrum value = c->weight * c->emission;
    for (int k = 0; k < 3; k++)
        v->sum[lane][k] += (double)value[k];
}

static inline void plain_surface(struct sink *s, int lane, const struct sink_surface *first) {
    (void)s, (void)lane, (void)first;
}

static inline void plain_covered(struct sink *s, int lane) {
    (void)s, (void)lane;
}

static inline void plain_end(struct sink *s, int lane, float weight) {
    struct plain_sink *v = (void *)s;
    for (int k = 0; k < 3 && v->pixel[lane]; k++)
        v->pixel[lane][k * v->width * v->height] += (double)weight * v->sum[lane][k];
}

static inline void plain_destroy(struct sink *s) {
    mem_free(s);
}

static const struct sink_type plain_type = {
    .open = plain_open, .close = plain_close, .place = plain_place, .begin = plain_begin,
    .add = plain_add, .surface = plain_surface, .covered = plain_covered, .end = plain_end,
    .destroy = plain_destroy};

static inline struct sink *plain_make(void *context) {
    struct plain_sink *v = mem_array(1, sizeof *v);
    *v = *(const struct plain_sink *)context;
    v->sink = (struct sink){.type = &plain_type, .chains = v->chains};
    return &v->sink;
}

// Traces the paths of a tensor with another response (NULL: the materials as they are).
static inline void plain_trace(const struct polynomial *p, const struct response *response,
                               uint32_t samples, double *frame) {
    const struct film_options *f = &p->job.film;
    struct plain_sink sink = {.grid = tile_grid_over((struct sink_area){f->x0, f->y0, f->x1, f->y1}),
                              .width = p->job.scene->film.width,
                              .height = p->job.scene->film.height, .frame = frame};
    // Asked at every vertex: the world shades what is editable as white where it shades together.
    const struct response whole = {.resolve = response_physical.resolve};
    struct tracer_options o = p->tracer;
    o.threads = 1;
    o.spp = samples;
    o.response = response ? response : &whole;
    const int values = 3 * sink.width * sink.height;
    for (int i = 0; i < values; i++)
        frame[i] = 0;
    struct tracer *t = tracer_create(&o, plain_make, &sink);
    tracer_run(t, 0, tile_grid_count(&sink.grid), 0, samples);
    tracer_destroy(t);
    for (int i = 0; i < values; i++)
        frame[i] /= samples;
}

// ---- opening, contracting ----------------------------------------------------------

// classes: of the scene that the tensor was made of; NULL: no object shares a factor.
static inline void edited_open_grouped(struct edited *e, const struct polynomial_options *o,
                                       const struct tensor *tensor,
                                       const struct edit_classes *classes) {
    memset(e, 0, sizeof *e);
    if (!polynomial_open(&e->p, o))
        exit(1);
    uint32_t places = 0;
    for (uint32_t i = 0; i < e->p.plan.count; i++) {
        const struct form *f = e->p.plan.objects[i].form;
        e->first[i] = places;
        for (uint32_t t = 0; t < f->terms; t++)
            places += symbolic_places(f, t);
    }
    e->weights = mem_array(places, sizeof *e->weights);
    e->albedos = mem_array(e->p.plan.count, sizeof *e->albedos);
    e->factors = mem_array(e->p.groups.factor_count, sizeof *e->factors);
    e->groups = mem_array(e->p.groups.count, sizeof *e->groups);
    edited_factors(e, tensor, classes ? classes : &e->p.classes);
    edited_groups(e);
    e->response.resolve = reference_resolve;
}

static inline void edited_open(struct edited *e, const struct polynomial_options *o,
                               const struct tensor *tensor) {
    edited_open_grouped(e, o, tensor, NULL);
}

static inline void edited_close(struct edited *e) {
    mem_free(e->weights);
    mem_free(e->albedos);
    mem_free(e->factors);
    mem_free(e->groups);
    polynomial_close(&e->p);
}

// The picture that a tensor says the edited scene has, [3][pixel]; or half the difference of its two
// estimates.
static inline void edited_contract(const struct edited *e, const struct tensor *t, bool halves,
                                   double *frame) {
    const uint32_t plane = t->width * t->height;
    for (uint32_t i = 0; i < 3 * plane; i++)
        frame[i] = t->fixed && !halves ? (double)t->fixed[i] : 0;
    uint32_t at = 0;
    for (uint32_t o = 0; o <= e->p.plan.count && at < t->block_count; o++) {
        const bool fixed = o == e->p.plan.count;
        const struct symbolic_object *object = fixed ? NULL : &e->p.objects[o];
        for (uint32_t term = 0; term < (fixed ? 1 : object->form->terms); term++) {
            const struct tensor_block *b = &t->blocks[at];
            if (strcmp(b->object, fixed ? "" : e->p.plan.objects[o].name) != 0)
                continue; // never seen
            at++;
            const uint32_t bins = b->coefficients / b->groups;
            for (uint64_t i = 0; i < b->pixel_count; i++)
                for (uint32_t c = 0; c < b->coefficients; c++)
                    for (uint32_t k = 0; k < 3; k++) {
                        const uint64_t tile = i / TENSOR_LANES, lane = i % TENSOR_LANES;
                        const float *v = halves ? b->halves : b->values;
                        const double w =
                            fixed ? 1 : e->weights[e->first[o] + object->first[term] + c % bins][k];
                        frame[k * plane + b->pixels[i]] +=
                            w * e->groups[c / bins][k] *
                            (double)v[((tile * b->coefficients + c) * 3 + k) * TENSOR_LANES + lane];
                    }
        }
    }
    CHECK(at == t->block_count);
}
