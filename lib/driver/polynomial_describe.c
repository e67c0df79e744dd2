// SPDX-License-Identifier: Apache-2.0
#include "driver/polynomial_describe.h"

#include <inttypes.h>
#include <stdio.h>

#include "base/thread.h"
#include "bsdf/equivalent_albedo.h"
#include "driver/origin.h"

// ---- albedos ------------------------------------------------------------------------------------

static void find_albedo(void *polynomial, size_t item, int worker) {
    const struct polynomial *p = polynomial;
    const size_t i = item / FORM_TERMS, t = item % FORM_TERMS;
    (void)worker;
    if (p->albedos[i][t])
        equivalent_albedo(p->plan.objects[i].form, (uint32_t)t, p->albedos[i][t]);
}

void polynomial_albedos(struct polynomial *p, int threads) {
    p->albedos = arena_alloc(&p->arena, p->plan.count * sizeof *p->albedos);
    for (uint32_t i = 0; i < p->plan.count; i++) {
        const struct form *f = p->plan.objects[i].form;
        for (uint32_t t = 0; t < f->terms; t++) {
            const size_t n = CURVE_CHANNELS * (size_t)symbolic_places(f, t);
            p->albedos[i][t] = arena_alloc(&p->arena, n * sizeof *p->albedos[i][t]);
        }
    }
    thread_for(threads, p->plan.count * FORM_TERMS, find_albedo, p);
}

static void describe_albedos(const struct polynomial *p, struct json *(*terms)[FORM_TERMS]) {
    for (uint32_t i = 0; i < p->plan.count; i++) {
        const struct form *f = p->plan.objects[i].form;
        for (uint32_t t = 0; t < f->terms; t++) {
            struct json *list = json_add_array(terms[i][t], "albedo");
            for (uint32_t k = 0; k < CURVE_CHANNELS * symbolic_places(f, t); k++)
                json_append_number(list, p->albedos[i][t][k]);
        }
    }
}

// ---- all ----------------------------------------------------------------------------------------

static void add_hash(struct json *j, const char *key, uint64_t hash) {
    char text[32];
    snprintf(text, sizeof text, "%016" PRIx64, hash);
    json_add_text(j, key, text);
}

// What samples depend on beside scene and seed.
static void describe_paths(const struct polynomial *p, struct json *meta) {
    const struct film_options *f = &p->job.film;
    const struct film_settings *film = &p->job.scene->film;
    const int area[6] = {film->width, film->height, f->x0, f->y0, f->x1, f->y1};
    struct json *paths = json_add_object(meta, "paths");
    json_add_count(paths, "max depth", p->path.max_depth);
    json_add_count(paths, "roulette depth", p->path.rr_depth);
    json_add_bool(paths, "hidden emitters", p->path.hide_emitters);
    json_add_bool(paths, "strict normals", p->path.strict_normals);
    json_add_text(paths, "sampler", p->tracer.sampler->entry.name);
    if (p->tracer.sampler->counted)
        json_add_count(paths, "sampler points", p->tracer.spp);
    add_hash(paths, "defines", p->job.defines_hash);
    struct json *list = json_add_array(paths, "size and crop");
    for (int i = 0; i < 6; i++)
        json_append_count(list, area[i]);
}

static void describe_radius(const struct polynomial *p, struct json *meta) {
    struct json *radius = json_add_array(meta, "radius");
    for (int k = 0; k < CURVE_CHANNELS; k++)
        json_append_number(radius, p->radius[k]);
}

// The samples of one range, and the unit of their sums.
static void describe_range(struct json *meta, uint32_t first, uint32_t end, double quantum) {
    struct json *range = json_append_array(json_add_array(meta, "ranges"));
    json_append_count(range, first);
    json_append_count(range, end);
    json_add_number(meta, "quantum", quantum);
}

struct json *polynomial_describe(const struct polynomial *p, const struct polynomial_options *o,
                                 uint32_t first, uint32_t end, double quantum) {
    struct json *meta = json_new_object();
    struct json *(*terms)[FORM_TERMS] = mem_array(p->plan.count, sizeof *terms);
    json_add_text(meta, "kind", "edit");
    json_add_text(meta, "command", o->command);
    json_add_text(meta, "program", o->version);
    origin_add(meta, &p->job, &o->job);
    json_add_count(meta, "samples", end - first);
    json_add_count(meta, "seed", o->job.seed);
    json_add_text(meta, "colour space", "linear Rec.709");
    json_add_text(meta, "lights", "monte carlo");
    json_add_count(meta, "bounces", o->bounces);
    struct json *series = json_add_array(meta, "series");
    for (uint32_t i = 0; i < o->bounces; i++)
        json_append_count(series, o->series[i]);
    json_add_text(meta, "tail", polynomial_tails[o->tail]);
    json_add_text(meta, "later", polynomial_laters[o->later]);
    if (o->tail == TAIL_GEOMETRIC)
        describe_radius(p, meta);
    describe_paths(p, meta);
    edit_plan_describe(&p->plan, meta, terms);
    describe_albedos(p, terms);
    edit_groups_describe(&p->groups, &p->plan, &p->classes, meta);
    if (o->keep)
        describe_range(meta, first, end, quantum);
    mem_free(terms);
    return meta;
}
