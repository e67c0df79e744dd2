// SPDX-License-Identifier: Apache-2.0
#include "edit_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "transport/tensor.h"

struct edit_picture edit_picture_make(int width, int height) {
    return (struct edit_picture){width, height, mem_array((size_t)(3 * width * height), sizeof(double))};
}

void edit_picture_free(struct edit_picture *p) {
    mem_free(p->rgb);
    *p = (struct edit_picture){0, 0, NULL};
}

// ---- by tensor ----------------------------------------------------------------------------------

// The curve f_o of a block, from the metadata.
static double curve_o(const struct json *meta, const struct tensor_block *b, double view, int channel) {
    const struct json *objects = json_get(meta, "objects");
    for (size_t i = 0; i < json_count(objects); i++) {
        const struct json *object = json_at(objects, i), *form = json_get(object, "form");
        const struct json *terms = json_get(form, "terms");
        for (size_t t = 0; t < json_count(terms); t++) {
            const struct json *term = json_at(terms, t), *slot = json_get(term, "f_o");
            int64_t index;
            if (strcmp(json_text(json_get(object, "name")), b->object) != 0 ||
                strcmp(json_text(json_get(term, "name")), b->term) != 0 ||
                !json_read_integer(json_get(slot, "curve"), &index))
                continue;
            const struct json *curve = json_at(json_get(form, "curves"), (size_t)index);
            const struct json *knots = json_get(curve, "knots"), *values = json_get(curve, "values");
            const struct json *own = json_at(values, json_count(values) > 1 ? (size_t)channel : 0);
            const bool hat = strcmp(json_text(json_get(curve, "basis")), "hat") == 0;
            size_t k = 0;
            double low = 0, high = 1, a = 0, c = 0;
            while (k + 2 < json_count(knots) && json_read_number(json_at(knots, k + 1), &high) &&
                   view >= high)
                k++;
            json_read_number(json_at(knots, k), &low);
            json_read_number(json_at(knots, k + 1), &high);
            json_read_number(json_at(own, k), &a);
            json_read_number(json_at(own, k + 1), &c);
            return hat ? a + (c - a) * (view - low) / (high - low) : a;
        }
    }
    return 1;
}

static double value_at(const struct tensor_block *b, size_t i) {
    return b->storage == TENSOR_BF16 ? (double)bf16_to_float(((const uint16_t *)b->values)[i])
                                     : (double)((const float *)b->values)[i];
}

static void add_block(const struct json *meta, const struct tensor_block *b, double *rgb) {
    for (uint64_t p = 0; p < b->pixel_count; p++)
        for (uint32_t c = 0; c < 3; c++) {
            double sum = 0;
            for (uint32_t j = 0; j < b->coefficients; j++)
                sum += value_at(b, ((p / TENSOR_LANES * b->coefficients + j) * 3 + c) * TENSOR_LANES +
                                       p % TENSOR_LANES) * (double)b->weights[3 * j + c];
            if (b->view)
                sum *= curve_o(meta, b, (double)b->view[p], (int)c);
            rgb[3 * (size_t)b->pixels[p] + c] += sum;
        }
}

bool edit_picture_replay(const char *path, bool fixed, struct edit_picture *out) {
    struct tensor_file *f = tensor_open(path);
    if (!f)
        return false;
    const struct tensor *t = tensor_get(f);
    const size_t plane = (size_t)t->width * t->height;
    const bool finite = tensor_check_values(f);
    *out = edit_picture_make((int)t->width, (int)t->height);
    for (size_t i = 0; i < plane && fixed && t->fixed; i++)
        for (size_t c = 0; c < 3; c++)
            out->rgb[3 * i + c] = (double)t->fixed[c * plane + i];
    for (uint32_t i = 0; i < t->block_count; i++)
        add_block(t->meta, &t->blocks[i], out->rgb);
    tensor_close(f);
    return finite;
}

bool edit_picture_by_tensor(const char *scene, const struct edit_options *options, bool fixed,
                            struct edit_picture *out, struct edit_report *report) {
    struct edit_options o = *options;
    struct edit_report unused;
    char path[4096];
    snprintf(path, sizeof path, "%s.safetensors", scene);
    o.job.scene = scene;
    o.output = path;
    o.command = o.version = "test";
    return precompute_edit(&o, report ? report : &unused) && edit_picture_replay(path, fixed, out);
}

// ---- by a plain loop ----------------------------------------------------------------------------

static struct direction middle_of(struct direction a, struct direction b) {
    return direction_of(a.x + b.x, a.y + b.y, a.z + b.z);
}

struct mean {
    const struct closure *closure;
    const struct surface *surface;
    const struct form *form;
    bool exact;
    double solid_angle, curves[FORM_TERMS][3], whole[3];
};

static double curve_at_place(const struct form *f, const struct form_slot *slot,
                             const struct curve_place *p, uint32_t c) {
    double sum = 0;
    if (slot->gamma.kind == GAMMA_NONE)
        return 1;
    for (uint32_t i = 0; i < p->count; i++)
        sum += curve_values(f->curve[slot->curve].f[c].table, c)[p->index[i]] * p->value[i];
    return sum;
}

// Averages over a triangle. Points below the surface count where the curves are asked for.
static void average(struct mean *m, const struct direction corner[3], int depth) {
    if (depth > 0) {
        const struct direction n[3] = {middle_of(corner[0], corner[1]), middle_of(corner[1], corner[2]),
                                       middle_of(corner[2], corner[0])};
        average(m, (struct direction[3]){corner[0], n[0], n[2]}, depth - 1);
        average(m, (struct direction[3]){corner[1], n[1], n[0]}, depth - 1);
        average(m, (struct direction[3]){corner[2], n[2], n[1]}, depth - 1);
        average(m, n, depth - 1);
        return;
    }
    struct editable_value v[FORM_TERMS];
    const double omega = solid_angle_within(corner);
    const struct direction d = direction_of(corner[0].x + corner[1].x + corner[2].x,
                                            corner[0].y + corner[1].y + corner[2].y,
                                            corner[0].z + corner[1].z + corner[2].z);
    const vec3 wi = to_local(&m->surface->point.frame, direction_round(d));
    vec3 inner_wi = wi;
    float factor = 1, pdf;
    const struct closure *inner = editable_inside(m->closure, &inner_wi, &factor);
    m->solid_angle += omega;
    if (m->exact) {
        const spectrum f = closure_eval(m->closure, wi, &pdf);
        for (int c = 0; c < 3; c++)
            m->whole[c] += omega * (double)f[c];
        return;
    }
    inner_wi[2] = maxf(inner_wi[2], 1e-4f); // as the last bin takes what lies beyond
    const uint32_t terms = editable_values(inner, normalize(inner_wi), v);
    for (uint32_t t = 0; t < terms; t++)
        for (uint32_t c = 0; c < 3; c++)
            m->curves[t][c] += omega * curve_at_place(m->form, &m->form->term[t].slots[SLOT_A],
                                                      &v[t].place[SLOT_A], c) *
                               curve_at_place(m->form, &m->form->term[t].slots[SLOT_B],
                                              &v[t].place[SLOT_B], c);
}

static void add_light(const struct world *w, const struct surface *s, const struct closure *closure,
                      const struct form *form, const struct light_triangle *l, int depth, bool exact,
                      float weight, double rgb[3]) {
    const vec3 wi = direction_round(l->centre);
    const struct ray ray = {surface_offset(s, wi), wi, 0, INFINITY};
    struct mean m = {.closure = closure, .surface = s, .form = form, .exact = exact};
    struct editable_value v[FORM_TERMS];
    vec3 local = to_local(&s->point.frame, wi);
    float factor = 1;
    const struct closure *inner = editable_inside(closure, &local, &factor);
    const uint32_t terms = factor > 0 ? editable_values(inner, local, v) : 0;
    if (terms == 0 || accel_occluded(w->accel, &ray))
        return;
    average(&m, l->corner, depth);
    for (uint32_t t = 0; t < terms; t++)
        for (uint32_t c = 0; c < 3; c++)
            rgb[c] += exact ? (t ? 0 : (double)weight * l->power[c] / m.solid_angle * m.whole[c])
                            : (double)(weight * factor * v[t].factor[c]) * l->power[c] *
                                  m.curves[t][c] / m.solid_angle *
                                  curve_at_place(form, &form->term[t].slots[SLOT_O],
                                                 &v[t].place[SLOT_O], c);
}

static void add_position(const struct job *job, const struct light_triangles *sky, int x, int y,
                         uint32_t position, int depth, bool exact, double rgb[3]) {
    const struct tracer_options *t = &job->render.tracer;
    struct sampler sampler = sampler_start(t->sampler, (uint32_t)x, (uint32_t)y, position, t->spp, 1,
                                           t->seed);
    struct closure_stack stack = {.used = 0};
    struct accel_hit hit;
    struct surface s;
    struct ray ray;
    float weight, factor = 1;
    vec3 any = v3(0, 0, 1);
    const struct vec2 d = filter_sample(t->filter, sampler_2d(&sampler), &weight);
    sensor_type_of(t->sensor)->ray(t->sensor->data, (float)x + 0.5f + d.x, (float)y + 0.5f + d.y,
                                   sampler_2d(&sampler), &ray);
    if (!accel_intersect(job->world->accel, &ray, &hit))
        return;
    world_surface(job->world, &ray, &hit, &s);
    const struct closure *c = bsdf_resolve(s.bsdf, &s.point, to_local(&s.point.frame, -ray.d), &stack);
    if (!c || !editable_inside(c, &any, &factor))
        return;
    const struct object material = {&bsdf_editable.entry,
                                    (void *)(uintptr_t)editable_owner(editable_inside(c, &any, &factor)),
                                    NULL, {NULL, 0}};
    for (uint32_t m = 0; m < sky->count; m++)
        if (light_loop_position(&sky->items[m], t->spp) == position)
            add_light(job->world, &s, c, editable_form(&material), &sky->items[m], depth, exact,
                      weight, rgb);
}

static void open_job(const char *scene, const struct edit_options *options, struct job *job) {
    struct job_options o = options->job;
    o.scene = scene;
    o.reading.integrator = "direct";
    if (!job_open(job, &o))
        exit(1);
}

static void init_lights(struct light_triangles *t, const struct job *job, uint32_t most) {
    struct sky sky = {world_environment, job->world, 0};
    for (uint32_t i = 0; i < job->world->infinite_count; i++) {
        const struct world_light *l = &job->world->lights[job->world->infinite[i]];
        sky.detail = l->type->detail ? (double)l->type->detail(l->data) : sky.detail;
    }
    light_triangles_init(t, &sky, most, 2);
}

void edit_picture_lights(const char *scene, const struct edit_options *options,
                         struct light_triangles *out) {
    struct job job;
    open_job(scene, options, &job);
    init_lights(out, &job, options->lights);
    job_close(&job);
}

void edit_picture_by_lights(const char *scene, const struct edit_options *options,
                            const struct light_triangles *sky, int depth, bool exact,
                            struct edit_picture *out) {
    struct job job;
    open_job(scene, options, &job);
    *out = edit_picture_make(job.scene->film.width, job.scene->film.height);
    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < out->width; x++)
            for (uint32_t p = 0; p < job.render.tracer.spp; p++)
                add_position(&job, sky, x, y, p, depth, exact, out->rgb + 3 * (y * out->width + x));
    job_close(&job);
}

void edit_picture_by_loop(const char *scene, const struct edit_options *options, int depth, bool exact,
                          struct edit_picture *out) {
    struct light_triangles sky;
    edit_picture_lights(scene, options, &sky);
    edit_picture_by_lights(scene, options, &sky, depth, exact, out);
    light_triangles_finish(&sky);
}

// ---- comparing ----------------------------------------------------------------------------------

double edit_picture_mean(const struct edit_picture *p) {
    const size_t n = (size_t)(3 * p->width * p->height);
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += p->rgb[i];
    return sum / (double)n;
}

double edit_picture_relmse(const struct edit_picture *a, const struct edit_picture *b) {
    const size_t n = (size_t)(3 * b->width * b->height);
    const double mean = edit_picture_mean(b);
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (a->rgb[i] - b->rgb[i]) * (a->rgb[i] - b->rgb[i]) /
               (b->rgb[i] * b->rgb[i] + 1e-3 * mean * mean);
    return sum / (double)n;
}

double edit_picture_largest(const struct edit_picture *a, const struct edit_picture *b) {
    const size_t n = (size_t)(3 * b->width * b->height);
    double most = 0, brightest = 0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, fabs(a->rgb[i] - b->rgb[i]));
        brightest = fmax(brightest, b->rgb[i]);
    }
    return most / brightest;
}

void edit_picture_write_sky(const char *path, int width, int height, edit_picture_radiance *of,
                            const void *ctx) {
    struct image im;
    if (!image_init(&im, width, height, 3))
        exit(1);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 3; c++)
                im.pixels[(y * width + x) * 3 + c] = (float)of(x, y, c, ctx);
    if (!image_write_exr(path, &im, NULL))
        exit(1);
    image_finish(&im);
}

enum { SUN_WIDE = 64, SUN_HIGH = 32 };

struct sun {
    double radiance;
    bool below_only;
};

static double sunny(int x, int y, int channel, const void *ctx) {
    const struct sun *s = ctx;
    const double even = y < SUN_HIGH / 2 ? 0.6 + 0.3 * sin(0.2 * x) : 0.2;
    (void)channel;
    if (s->below_only && y <= SUN_HIGH / 2 + 1)
        return 0;
    return x == 20 && y == 8 ? even + s->radiance : even;
}

void edit_picture_write_sun(const char *path, double radiance, bool below_only) {
    edit_picture_write_sky(path, SUN_WIDE, SUN_HIGH, sunny, &(struct sun){radiance, below_only});
}
