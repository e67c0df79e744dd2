// SPDX-License-Identifier: Apache-2.0
// Light that reaches a visit, added to the coefficients of its terms.
#include <string.h>

#include "integrator/light_loop_data.h"
#include "integrator/wide_angles.h"

// A visit that is being added up.
struct shading {
    struct light_loop *loop;
    const struct visit *visit;
    const struct form *form;
    struct wide_overlap *terms;
    const struct wide_quotient *quotients; // of the terms
    const struct closure *outer, *inner;
    vec3 rows[3];
    struct direction wo;
    double texture[FORM_TERMS][CURVE_CHANNELS]; // times the visit's weight
};

// ---- light from one direction -------------------------------------------------------------------

// What a term makes of light from wi (in the shading frame), all but curves and f_q; the directions
// in the frame of the closure are left in *a. false: nothing.
static bool angles_to(const struct shading *s, vec3 wi, float *factor, struct angles *a) {
    *factor = 1;
    if (!editable_inside(s->outer, &wi, factor) || !(*factor > 0) || !(cos_theta(wi) > 0))
        return false;
    const struct direction i = direction_from(wi);
    *a = angles_make((double[3]){s->wo.x, s->wo.y, s->wo.z}, (double[3]){i.x, i.y, i.z});
    return true;
}

static void light_of_term(const struct shading *s, uint32_t term, struct angles *a,
                          const double light[CURVE_CHANNELS], double out[CURVE_CHANNELS]) {
    quotient_cos(&s->form->term[term].quotient, a, out);
    for (int k = 0; k < CURVE_CHANNELS; k++)
        out[k] *= s->texture[term][k] * light[k];
}

static void add_point(const struct shading *s, struct angles *a, const double light[CURVE_CHANNELS]) {
    for (uint32_t t = 0; t < s->form->terms; t++) {
        struct overlap *o = &s->terms[t].scalar;
        double gamma[OVERLAP_AXES], share[CURVE_CHANNELS];
        light_of_term(s, t, a, light, share);
        for (uint32_t x = 0; x < o->axes; x++)
            gamma[x] = overlap_gamma(&o->axis[x].gamma, a);
        overlap_add_point(o, gamma, share);
    }
}

// ---- triangles ----------------------------------------------------------------------------------

// WIDE_LANES triangles, with what all terms need of them.
struct bundle {
    const struct arrival *list;
    uint32_t count;
    struct wide_nodes nodes; // in the frame of the closure
    struct wide_fit fit[FORM_TERMS][OVERLAP_AXES];
    wide quotient[FORM_TERMS][CURVE_CHANNELS]; // times cosine, at the centres
};

// What rows of the triangles hold.
static void load_rows(const struct shading *s, const struct bundle *b, int row, wide out[4]) {
    const float *from[WIDE_LANES];
    for (uint32_t i = 0; i < WIDE_LANES; i++)
        from[i] = s->loop->scene->rows[b->list[i < b->count ? i : 0].light].row[row];
    wide_gather4(from, out);
}

// Directions in the frame of the closure.
static struct wide3 load_local(const struct shading *s, const struct bundle *b, int row) {
    wide d[4];
    load_rows(s, b, row, d);
    const struct wide3 w = {d[0], d[1], d[2]};
    return (struct wide3){wide_dot(wide3_of(s->rows[0]), w), wide_dot(wide3_of(s->rows[1]), w),
                          wide_dot(wide3_of(s->rows[2]), w)};
}

static void find_gammas(const struct shading *s, struct bundle *b) {
    wide centre[4];
    for (int i = 0; i < OVERLAP_NODES; i++)
        b->nodes.node[i] = load_local(s, b, i);
    load_rows(s, b, LIGHT_PARTS, b->nodes.part);
    load_rows(s, b, LIGHT_CENTRE, centre);
    b->nodes.tolerance = centre[3];
    for (uint32_t t = 0; t < s->form->terms; t++) {
        const struct wide_overlap *o = &s->terms[t];
        wide gamma[OVERLAP_AXES][OVERLAP_NODES];
        for (uint32_t x = 0; x < o->scalar.axes; x++)
            for (int i = 0; i < OVERLAP_NODES; i++)
                gamma[x][i] = wide_gamma(&o->scalar.axis[x].gamma, s->wo, &b->nodes.node[i]);
        wide_overlap_fit(o, &b->nodes, gamma, b->fit[t]);
    }
}

static void find_quotients(const struct shading *s, struct bundle *b) {
    const struct wide3 centres = load_local(s, b, LIGHT_CENTRE);
    for (uint32_t t = 0; t < s->form->terms; t++)
        if (s->quotients[t].fits)
            wide_quotient_cos(&s->quotients[t], s->wo, &centres, b->quotient[t]);
}

// What the terms without a wide quotient give for one of the triangles.
static void find_quotient(const struct shading *s, struct bundle *b, uint32_t term, uint32_t i,
                          vec3 wi) {
    double out[CURVE_CHANNELS] = {0};
    struct angles a;
    float factor;
    if (angles_to(s, wi, &factor, &a))
        quotient_cos(&s->form->term[term].quotient, &a, out);
    for (int k = 0; k < CURVE_CHANNELS; k++)
        b->quotient[term][k][i] = (float)out[k];
}

// What wrappers leave of light to a visit; plain ones leave all.
static float factor_of(const struct shading *s, vec3 wi) {
    float factor = 1;
    if (s->outer != s->inner)
        editable_inside(s->outer, &wi, &factor);
    return factor;
}

static void add_triangle(const struct shading *s, struct bundle *b, uint32_t i) {
    const struct light_loop_scene *scene = s->loop->scene;
    const struct arrival *arrival = &b->list[i];
    const struct light_triangle *l = &scene->options.lights->items[arrival->light];
    const vec3 wi = to_local(&s->visit->surface.point.frame, scene->centres[arrival->light]);
    const double factor = (double)factor_of(s, wi);
    double light[CURVE_CHANNELS];
    if (!(factor > 0))
        return;
    for (uint32_t t = 0; t < s->form->terms; t++) {
        if (!s->quotients[t].fits)
            find_quotient(s, b, t, i, wi);
        for (int k = 0; k < CURVE_CHANNELS; k++)
            light[k] = l->power[k] * factor * (double)(arrival->through[k] * b->quotient[t][k][i]) *
                       s->texture[t][k];
        wide_overlap_add(&s->terms[t], b->fit[t], &b->nodes, i, &scene->triangles[arrival->light], light);
    }
}

// The same triangle as a point at its centre.
static void add_centre(const struct shading *s, const struct arrival *arrival) {
    const struct light_loop_scene *scene = s->loop->scene;
    const struct light_triangle *l = &scene->options.lights->items[arrival->light];
    double light[CURVE_CHANNELS];
    struct angles a;
    float factor;
    if (!angles_to(s, to_local(&s->visit->surface.point.frame, scene->centres[arrival->light]),
                   &factor, &a))
        return;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        light[k] = l->power[k] * (double)(factor * arrival->through[k]);
    add_point(s, &a, light);
}

static void add_triangles(const struct shading *s, const struct arrival *list, uint32_t count) {
    struct bundle b;
    if (s->loop->scene->options.as_points) {
        for (uint32_t i = 0; i < count; i++)
            add_centre(s, &list[i]);
        return;
    }
    b.list = list;
    b.count = count;
    find_gammas(s, &b);
    find_quotients(s, &b);
    for (uint32_t i = 0; i < count; i++)
        add_triangle(s, &b, i);
}

// ---- other lights -------------------------------------------------------------------------------

_Static_assert((int)LIGHT_LOOP_SPARE >= (int)WIDE_OVERLAP_SPARE, "sums have room");

// Terms follow one another in the sums.
static void aim_sums(const struct shading *s, double *sums) {
    for (uint32_t t = 0; t < s->form->terms; t++) {
        struct overlap *o = &s->terms[t].scalar;
        o->sums = sums;
        sums += (size_t)CURVE_CHANNELS * (o->axes > 0 ? o->axis[0].basis.count : 1) *
                (o->axes > 1 ? o->axis[1].basis.count : 1);
    }
}

// One sample; `sign` is how it counts in the difference of the halves.
static void add_sample(const struct shading *s, struct sampler *sampler, double share, double sign,
                       double *sums, double *halves) {
    const struct light_loop_scene *scene = s->loop->scene;
    const struct surface *surface = &s->visit->surface;
    const struct light_place place = {surface->p, s->rows[2]};
    struct light_sample l;
    struct angles a;
    double light[CURVE_CHANNELS];
    uint32_t index;
    float factor;
    const float u = sampler_1d(sampler);
    if (!light_choice_sample(&scene->choice, scene->others, scene->other_count, &place, u,
                             sampler_2d(sampler), &index, &l) ||
        !angles_to(s, to_local(&surface->point.frame, l.wi), &factor, &a))
        return;
    const spectrum emission = l.late ? light_late_emission(&scene->others[index], l.wi) : l.emission;
    const spectrum through = spectrum_is_black(emission) ? emission : world_transmittance(
        scene->options.world, world_shadow_ray(surface, &l), -1, surface->point.wavelengths);
    if (spectrum_is_black(through))
        return;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        light[k] = (double)(emission[k] * through[k] * factor / l.pdf_sa) * share;
    add_point(s, &a, light);
    if (!halves)
        return;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        light[k] *= sign;
    aim_sums(s, halves);
    add_point(s, &a, light);
    aim_sums(s, sums);
}

static void add_others(const struct shading *s, double *sums, double *halves) {
    const struct light_loop_options *o = &s->loop->scene->options;
    const struct visit *v = s->visit;
    const uint32_t x = (uint32_t)s->loop->x + v->pixel % LIGHT_LOOP_SIDE;
    const uint32_t y = (uint32_t)s->loop->y + v->pixel / LIGHT_LOOP_SIDE;
    const uint32_t all = o->positions * o->light_samples;
    for (uint32_t i = 0; i < o->light_samples; i++) {
        struct sampler sampler = sampler_start(o->sampler, x, y, v->position * o->light_samples + i,
                                               all, 2, o->seed + 1);
        add_sample(s, &sampler, 1.0 / all, i % 2 ? -1 : 1, sums, halves);
    }
}

// ---- a pixel ------------------------------------------------------------------------------------

static bool begin_visit(struct shading *s, struct light_loop *l, const struct visit *v) {
    s->visit = v;
    s->inner = visit_resolve(v, &l->stack, &s->outer, s->rows);
    if (!s->inner)
        return false;
    s->wo = editable_wo(s->inner);
    for (uint32_t t = 0; t < s->form->terms; t++) {
        struct overlap *o = &s->terms[t].scalar;
        const spectrum texture = editable_texture_at(s->inner, t) * v->weight;
        o->wo[0] = s->wo.x;
        o->wo[1] = s->wo.y;
        o->wo[2] = s->wo.z;
        for (int k = 0; k < 3; k++) {
            s->texture[t][k] = (double)texture[k];
            for (int i = 0; i < 3; i++)
                o->to_local[k][i] = (double)s->rows[k][i];
        }
    }
    return true;
}

static void add_visit(struct shading *s, struct light_loop *l, size_t visit, double *sums,
                      double *halves) {
    const struct arrival *list = l->arrivals + visit * l->most;
    const uint32_t count = l->visits[visit].count;
    for (uint32_t i = 0; i < count; i += WIDE_LANES)
        add_triangles(s, list + i, count - i < WIDE_LANES ? count - i : WIDE_LANES);
    if (l->scene->other_count > 0)
        add_others(s, sums, halves);
}

void light_loop_sum(struct light_loop *l, uint32_t pixel, uint32_t object, double *sums,
                    double *halves) {
    const struct light_loop_scene *scene = l->scene;
    const size_t n = (size_t)scene->coefficients[object] * CURVE_CHANNELS;
    struct shading s = {.loop = l, .form = scene->options.objects[object].form,
                        .terms = l->overlaps[object], .quotients = l->quotients[object]};
    memset(sums, 0, n * sizeof *sums);
    if (halves)
        memset(halves, 0, n * sizeof *halves);
    aim_sums(&s, sums);
    for (size_t i = 0; i < l->visit_count; i++) {
        const struct visit *v = &l->visits[i];
        if (v->pixel == pixel && v->object == object && begin_visit(&s, l, v))
            add_visit(&s, l, i, sums, halves);
    }
}
