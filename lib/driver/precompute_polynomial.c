// SPDX-License-Identifier: Apache-2.0
#include "driver/precompute_polynomial.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/thread.h"
#include "bsdf/equivalent_albedo.h"

enum { STRIPS_BETWEEN_REPORTS = 8, DRY_TILES = 4, DRY_SAMPLES = 16 };

// The tensor's blocks, and the sums that fill them.
struct layout {
    struct polynomial *p;
    const struct polynomial_options *options;
    struct first_seen *seen;
    struct edit_sums_object *objects; // the last one: fixed surfaces
    struct edit_sums_options sums;
    struct tensor_block *blocks;
    uint32_t (*owner)[2];             // by block: object, term
    struct tensor tensor;
};

static struct sink_area area_of(const struct polynomial *p) {
    const struct film_options *f = &p->job.film;
    return (struct sink_area){f->x0, f->y0, f->x1, f->y1};
}

// ---- the survey -------------------------------------------------------------------------------

// Camera rays alone, of the samples that will be traced, so that every object they meet is known.
static bool survey(struct layout *l, uint32_t samples) {
    const struct polynomial *p = l->p;
    struct tracer_options o = p->tracer;
    o.response = &p->survey.response;
    l->seen = first_seen_create(area_of(p), p->job.scene->film.width, p->plan.count + 1);
    struct tracer *t = tracer_create(&o, first_seen_sink, l->seen);
    const bool whole = tracer_run(t, 0, tile_grid_count(&l->seen->grid), 0, samples) &&
                       !(o.stop && *o.stop);
    tracer_destroy(t);
    first_seen_list(l->seen);
    return whole;
}

// ---- the blocks -------------------------------------------------------------------------------

static void add_block(struct layout *l, struct tensor_block b, uint32_t object, uint32_t term) {
    static const float some;
    struct edit_sums_object *o = &l->objects[object];
    const struct seen_list *list = &l->seen->lists[object];
    o->first[term] = o->places;
    o->bins[term] = b.coefficients;
    o->places += b.coefficients;
    o->terms = term + 1;
    b.groups = l->p->groups.count;
    b.coefficients *= b.groups;
    b.channels = CURVE_CHANNELS;
    b.pixel_count = list->count;
    b.pixels = list->pixels;
    b.storage = l->options->storage;
    b.halves = &some;
    l->owner[l->tensor.block_count][0] = object;
    l->owner[l->tensor.block_count][1] = term;
    l->blocks[l->tensor.block_count++] = b;
}

static void make_blocks(struct layout *l) {
    const struct edit_plan *plan = &l->p->plan;
    l->objects = mem_array(plan->count + 1, sizeof *l->objects);
    l->blocks = mem_array(plan->count * FORM_TERMS + 1, sizeof *l->blocks);
    l->owner = mem_array(plan->count * FORM_TERMS + 1, sizeof *l->owner);
    for (uint32_t i = 0; i < plan->count; i++)
        for (uint32_t t = 0; t < plan->objects[i].form->terms; t++) {
            struct tensor_block b;
            if (l->seen->lists[i].count == 0) // it lights others only
                continue;
            edit_plan_block(plan, i, t, &b);
            if (edit_term_has(&plan->objects[i].form->term[t], SLOT_O))
                b.view = l->seen->lists[i].view;
            add_block(l, b, i, t);
        }
    l->objects[plan->count].places = 0;
    if (l->p->groups.count > 1 && l->seen->lists[plan->count].count > 0)
        add_block(l, (struct tensor_block){.object = "", .term = "fixed", .coefficients = 1},
                  plan->count, 0);
}

static void make_layout(struct layout *l) {
    static const float some;
    struct polynomial *p = l->p;
    make_blocks(l);
    l->sums = (struct edit_sums_options){
        .area = area_of(p), .width = p->job.scene->film.width, .height = p->job.scene->film.height,
        .samples = p->tracer.spp, .groups = p->groups.count, .objects = l->objects, .seen = l->seen,
        .storage = l->options->storage, .parts = 1};
    l->tensor.width = (uint32_t)l->sums.width;
    l->tensor.height = (uint32_t)l->sums.height;
    l->tensor.blocks = l->blocks;
    l->tensor.fixed = &some;
}

static void finish_layout(struct layout *l) {
    first_seen_destroy(l->seen);
    mem_free(l->objects);
    mem_free(l->blocks);
    mem_free(l->owner);
}

static uint64_t file_bytes(const struct layout *l) {
    uint64_t bytes = (uint64_t)l->tensor.width * l->tensor.height * 12;
    for (uint32_t i = 0; i < l->tensor.block_count; i++)
        bytes += 2 * tensor_bytes(&l->blocks[i]) + 4 * l->blocks[i].pixel_count;
    return bytes;
}

// ---- the metadata -----------------------------------------------------------------------------

static void describe_albedos(const struct polynomial *p, struct json *(*terms)[FORM_TERMS]) {
    for (uint32_t i = 0; i < p->plan.count; i++) {
        const struct form *f = p->plan.objects[i].form;
        for (uint32_t t = 0; t < f->terms; t++) {
            const uint32_t n = CURVE_CHANNELS * symbolic_places(f, t);
            double *e = mem_array(n, sizeof *e);
            struct json *list = json_add_array(terms[i][t], "albedo");
            equivalent_albedo(f, t, e);
            for (uint32_t k = 0; k < n; k++)
                json_append_number(list, e[k]);
            mem_free(e);
        }
    }
}

static struct json *describe(const struct layout *l) {
    const struct polynomial_options *o = l->options;
    const struct polynomial *p = l->p;
    struct json *meta = json_new_object();
    struct json *(*terms)[FORM_TERMS] = mem_array(p->plan.count, sizeof *terms);
    char hash[32];
    json_add_text(meta, "kind", "edit");
    json_add_text(meta, "command", o->command);
    json_add_text(meta, "program", o->version);
    snprintf(hash, sizeof hash, "%016" PRIx64, p->job.scene->hash);
    json_add_text(meta, "scene hash", hash);
    json_add_text(meta, "scene", o->job.scene);
    json_add_count(meta, "samples", p->tracer.spp);
    json_add_count(meta, "seed", o->job.seed);
    json_add_text(meta, "colour space", "linear Rec.709");
    json_add_text(meta, "lights", "monte carlo");
    json_add_count(meta, "bounces", o->bounces);
    struct json *series = json_add_array(meta, "series");
    for (uint32_t i = 0; i < o->bounces; i++)
        json_append_count(series, o->series[i]);
    json_add_text(meta, "tail", o->tail == TAIL_FROZEN ? "frozen" : "none");
    edit_plan_describe(&p->plan, meta, terms);
    describe_albedos(p, terms);
    edit_groups_describe(&p->groups, &p->plan, meta);
    mem_free(terms);
    return meta;
}

// ---- memory -----------------------------------------------------------------------------------

static int threads_of(const struct layout *l) {
    return l->options->job.threads > 0 ? l->options->job.threads : thread_default_count();
}

// Cuts tiles into strips until the sums of all threads fit. false after an error message.
static bool fit_memory(struct layout *l, struct polynomial_report *r) {
    const double there = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    const double most = l->options->most_memory > 0 ? l->options->most_memory : there / 2;
    for (l->sums.parts = 1; l->sums.parts <= EDIT_MOST_PARTS; l->sums.parts *= 2) {
        r->sums_bytes = (uint64_t)threads_of(l) * edit_sums_worker_bytes(&l->sums);
        if ((double)r->sums_bytes <= most)
            return true;
    }
    log_error("the sums of %d strips of 4 rows at once take %.1f GB, more than the %.1f GB of "
              "--memory; take fewer --threads, bounces or bins", threads_of(l),
              (double)r->sums_bytes * 1e-9, most * 1e-9);
    return false;
}

// ---- tracing ----------------------------------------------------------------------------------

static bool trace(struct layout *l, uint32_t first, uint32_t count, uint32_t samples,
                  struct polynomial_report *report) {
    const struct polynomial_options *options = l->options;
    const struct tracer_options *o = &l->p->tracer;
    struct edit_sums *sums = edit_sums_create(&l->sums);
    struct tracer *tracer = tracer_create(o, edit_sums_sink, sums);
    bool whole = true;
    for (uint32_t done = 0; done < count && whole; done += STRIPS_BETWEEN_REPORTS) {
        const uint32_t left = count - done;
        const uint32_t n = left < STRIPS_BETWEEN_REPORTS ? left : STRIPS_BETWEEN_REPORTS;
        whole = tracer_run(tracer, first + done, n, 0, samples) && !(o->stop && *o->stop);
        if (options->progress)
            options->progress(options->user, (double)(done + n) / count);
    }
    const struct tracer_counts n = tracer_count(tracer);
    report->paths = n.paths;
    report->rays = n.rays + n.shadow_rays;
    report->rejected = edit_sums_rejected(sums);
    tracer_destroy(tracer);
    edit_sums_destroy(sums);
    return whole;
}

static uint32_t strip_count(const struct layout *l) {
    return tile_grid_count(&l->seen->grid) * l->sums.parts;
}

static bool write_tensor(struct layout *l, struct polynomial_report *report) {
    struct json *meta = describe(l);
    l->tensor.meta = meta;
    struct tensor_writer *w = tensor_create(l->options->output, &l->tensor);
    json_destroy(meta);
    if (!w)
        return false;
    for (uint32_t i = 0; i < l->tensor.block_count; i++) {
        struct edit_sums_object *o = &l->objects[l->owner[i][0]];
        o->values[l->owner[i][1]] = tensor_values(w, i);
        o->halves[l->owner[i][1]] = tensor_halves(w, i);
    }
    l->sums.fixed = tensor_fixed(w);
    const double start = time_seconds();
    report->stopped = !trace(l, 0, strip_count(l), l->p->tracer.spp, report);
    report->seconds += time_seconds() - start;
    if (!report->stopped)
        return tensor_finish(w);
    tensor_abandon(w);
    return false;
}

// Traces a few strips into nothing, to tell how long all would take.
static void estimate(struct layout *l, struct polynomial_report *report) {
    const uint32_t all = strip_count(l), n = all < DRY_TILES ? all : DRY_TILES;
    const uint32_t spp = l->p->tracer.spp, samples = spp < DRY_SAMPLES ? spp : DRY_SAMPLES;
    l->sums.fixed = mem_array(3 * (size_t)l->sums.width * (size_t)l->sums.height, sizeof(float));
    const double start = time_seconds();
    trace(l, (all - n) / 2, n, samples, report);
    report->seconds += (time_seconds() - start) * all / n * spp / samples;
    mem_free(l->sums.fixed);
}

static bool run(struct layout *l, struct polynomial_report *report) {
    const bool dry = l->options->dry_run;
    const uint32_t spp = l->p->tracer.spp;
    const double start = time_seconds();
    if (!survey(l, dry && spp > DRY_SAMPLES ? DRY_SAMPLES : spp)) {
        report->stopped = true;
        return false;
    }
    report->seconds = time_seconds() - start;
    make_layout(l);
    report->objects = l->p->plan.count;
    report->groups = l->p->groups.count;
    for (uint32_t i = 0; i < l->tensor.block_count; i++)
        report->coefficients += l->blocks[i].coefficients;
    report->samples = spp;
    report->file_bytes = file_bytes(l);
    if (!fit_memory(l, report))
        return false;
    if (!dry)
        return write_tensor(l, report);
    estimate(l, report);
    return true;
}

bool precompute_polynomial(const struct polynomial_options *o, struct polynomial_report *report) {
    struct polynomial p;
    struct layout l = {.p = &p, .options = o};
    *report = (struct polynomial_report){0};
    if (!polynomial_open(&p, o))
        return false;
    const bool done = run(&l, report);
    if (report->stopped)
        log_error("stopped before the tensor was whole: %s is not written", o->output);
    finish_layout(&l);
    polynomial_close(&p);
    return done;
}
