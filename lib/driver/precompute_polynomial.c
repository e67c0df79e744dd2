// SPDX-License-Identifier: Apache-2.0
#include "driver/precompute_polynomial.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/thread.h"
#include "bsdf/equivalent_albedo.h"
#include "driver/polynomial_layout.h"
#include "driver/polynomial_resume.h"
#include "driver/polynomial_pilot.h"

enum { STRIPS_BETWEEN_REPORTS = 8, DRY_TILES = 4, DRY_SAMPLES = 16, BLOCK = 64 };

struct run {
    struct polynomial *p;
    const struct polynomial_options *options;
    struct polynomial_report *report;
    struct polynomial_layout layout; // of the range that is worked on
    double start, quantum;
    double *(*albedos)[FORM_TERMS];
    uint32_t first, end;             // samples that are asked for
};

// ---- the metadata -----------------------------------------------------------------------------

static int threads_of(const struct run *r) {
    return r->options->job.threads > 0 ? r->options->job.threads : thread_default_count();
}

static void find_albedo(void *run, size_t item, int worker) {
    const struct run *r = run;
    const size_t i = item / FORM_TERMS, t = item % FORM_TERMS;
    (void)worker;
    if (r->albedos[i][t])
        equivalent_albedo(r->p->plan.objects[i].form, (uint32_t)t, r->albedos[i][t]);
}

// Equivalent albedos of all terms, for all passes.
static void find_albedos(struct run *r) {
    struct polynomial *p = r->p;
    r->albedos = arena_alloc(&p->arena, p->plan.count * sizeof *r->albedos);
    for (uint32_t i = 0; i < p->plan.count; i++) {
        const struct form *f = p->plan.objects[i].form;
        for (uint32_t t = 0; t < f->terms; t++) {
            const size_t n = CURVE_CHANNELS * (size_t)symbolic_places(f, t);
            r->albedos[i][t] = arena_alloc(&p->arena, n * sizeof *r->albedos[i][t]);
        }
    }
    thread_for(threads_of(r), p->plan.count * FORM_TERMS, find_albedo, r);
}

static void describe_albedos(const struct run *r, struct json *(*terms)[FORM_TERMS]) {
    for (uint32_t i = 0; i < r->p->plan.count; i++) {
        const struct form *f = r->p->plan.objects[i].form;
        for (uint32_t t = 0; t < f->terms; t++) {
            struct json *list = json_add_array(terms[i][t], "albedo");
            for (uint32_t k = 0; k < CURVE_CHANNELS * symbolic_places(f, t); k++)
                json_append_number(list, r->albedos[i][t][k]);
        }
    }
}

static struct json *describe(const struct run *r, uint32_t end) {
    const struct polynomial_options *o = r->options;
    const struct polynomial *p = r->p;
    struct json *meta = json_new_object();
    struct json *(*terms)[FORM_TERMS] = mem_array(p->plan.count, sizeof *terms);
    char hash[32];
    json_add_text(meta, "kind", "edit");
    json_add_text(meta, "command", o->command);
    json_add_text(meta, "program", o->version);
    snprintf(hash, sizeof hash, "%016" PRIx64, p->job.scene->hash);
    json_add_text(meta, "scene hash", hash);
    json_add_text(meta, "scene", o->job.scene);
    json_add_count(meta, "samples", end - r->first);
    json_add_count(meta, "seed", o->job.seed);
    json_add_text(meta, "colour space", "linear Rec.709");
    json_add_text(meta, "lights", "monte carlo");
    json_add_count(meta, "bounces", o->bounces);
    struct json *series = json_add_array(meta, "series");
    for (uint32_t i = 0; i < o->bounces; i++)
        json_append_count(series, o->series[i]);
    json_add_text(meta, "tail", polynomial_tails[o->tail]);
    json_add_text(meta, "later", polynomial_laters[o->later]);
    if (o->tail == TAIL_GEOMETRIC) {
        struct json *radius = json_add_array(meta, "radius");
        for (int k = 0; k < CURVE_CHANNELS; k++)
            json_append_number(radius, p->radius[k]);
    }
    edit_plan_describe(&p->plan, meta, terms);
    describe_albedos(r, terms);
    edit_groups_describe(&p->groups, &p->plan, &p->classes, meta);
    if (o->keep)
        polynomial_resume_describe(meta, p, r->first, end, r->quantum);
    mem_free(terms);
    return meta;
}

// ---- memory -----------------------------------------------------------------------------------

// Cuts tiles into strips until the sums of all threads fit. false after an error message.
static bool fit_memory(struct run *r) {
    struct edit_sums_options *sums = &r->layout.sums;
    const double there = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    const double most = r->options->most_memory > 0 ? r->options->most_memory : there / 2;
    for (sums->parts = 1; sums->parts <= EDIT_MOST_PARTS; sums->parts *= 2) {
        r->report->sums_bytes = (uint64_t)threads_of(r) * edit_sums_worker_bytes(sums);
        if ((double)r->report->sums_bytes <= most)
            return true;
    }
    log_error("the sums of %d strips of 4 rows at once take %.1f GB, more than the %.1f GB of "
              "--memory; take fewer --threads, bounces or bins", threads_of(r),
              (double)r->report->sums_bytes * 1e-9, most * 1e-9);
    return false;
}

// ---- tracing ----------------------------------------------------------------------------------

static uint32_t strip_count(const struct run *r) {
    return tile_grid_count(&r->layout.seen->grid) * r->layout.sums.parts;
}

static void tell(const struct run *r, uint32_t sample, uint32_t samples, double done) {
    if (r->options->progress)
        r->options->progress(r->options->user,
                             (sample - r->first + samples * done) / (r->end - r->first));
}

static bool trace(struct run *r, uint32_t strip, uint32_t strips, uint32_t first, uint32_t samples) {
    const struct tracer_options *o = &r->p->tracer;
    struct edit_sums *sums = edit_sums_create(&r->layout.sums);
    struct tracer *tracer = tracer_create(o, edit_sums_sink, sums);
    bool whole = true;
    for (uint32_t done = 0; done < strips && whole; done += STRIPS_BETWEEN_REPORTS) {
        const uint32_t left = strips - done;
        const uint32_t n = left < STRIPS_BETWEEN_REPORTS ? left : STRIPS_BETWEEN_REPORTS;
        whole = tracer_run(tracer, strip + done, n, first, samples) && !(o->stop && *o->stop);
        tell(r, first, samples, (double)(done + n) / strips);
    }
    const struct tracer_counts n = tracer_count(tracer);
    r->report->paths += n.paths;
    r->report->rays += n.rays + n.shadow_rays;
    r->report->rejected += edit_sums_rejected(sums);
    tracer_destroy(tracer);
    edit_sums_destroy(sums);
    return whole;
}

// ---- passes -----------------------------------------------------------------------------------

static bool open_layout(struct run *r, const struct tensor *base, uint32_t next, uint32_t end) {
    const struct polynomial_range range = {
        .first = next, .end = end, .before = next - r->first, .base = base,
        .keep_sums = r->options->keep, .storage = r->options->storage, .quantum = r->quantum};
    struct polynomial_report *report = r->report;
    if (!polynomial_layout_init(&r->layout, r->p, &range)) {
        report->stopped = r->p->tracer.stop && *r->p->tracer.stop;
        return report->stopped ? false : (log_error("%s: is not of this scene and these options",
                                                    r->options->output), false);
    }
    report->objects = r->p->plan.count;
    report->groups = r->p->groups.count;
    report->coefficients = 0;
    for (uint32_t i = 0; i < r->layout.tensor.block_count; i++)
        report->coefficients += r->layout.blocks[i].coefficients;
    report->file_bytes = polynomial_layout_bytes(&r->layout);
    return fit_memory(r);
}

// Traces samples and writes the tensor of all so far. false after an error message, or stopped.
static bool write_pass(struct run *r, const struct tensor *base, uint32_t next, uint32_t end) {
    bool whole = open_layout(r, base, next, end);
    struct json *meta = whole ? describe(r, end) : NULL;
    r->layout.tensor.meta = meta;
    struct tensor_writer *w = whole ? tensor_create(r->options->output, &r->layout.tensor) : NULL;
    json_destroy(meta);
    if (w) {
        polynomial_layout_tie(&r->layout, w);
        whole = trace(r, 0, strip_count(r), next, end - next);
        r->report->stopped = !whole;
        if (!whole)
            tensor_abandon(w);
    }
    polynomial_layout_finish(&r->layout);
    return w && whole && tensor_finish(w);
}

// Samples of the next pass: whole blocks, and about as long as the time between checkpoints, or as
// is left; first of all a few, to see what they cost.
static uint32_t pass_length(const struct run *r, uint32_t done, uint32_t next, double seconds) {
    const struct polynomial_options *o = r->options;
    const double left = o->job.seconds > 0 ? fmax(o->job.seconds - seconds, 0) : HUGE_VAL;
    const double wished = fmin(o->checkpoint > 0 ? o->checkpoint : HUGE_VAL, left);
    double n = r->end - next;
    if (wished < HUGE_VAL)
        n = fmin(n, done == 0 ? BLOCK : fmin(wished * done / seconds, 4.0 * done));
    n = fmax(floor(n / BLOCK) * BLOCK, BLOCK);
    return n < r->end - next ? (uint32_t)n : r->end - next;
}

// Passes from `next` on, each from the tensor that the one before has left.
static bool run_passes(struct run *r, struct tensor_file *base, uint32_t next) {
    const double most = r->options->job.seconds;
    const uint32_t from = next;
    bool done = true;
    while (done && next < r->end && !(next > r->first && most > 0 && r->report->seconds >= most)) {
        const uint32_t n = pass_length(r, next - from, next, r->report->seconds);
        done = write_pass(r, base ? tensor_get(base) : NULL, next, next + n);
        next += done ? n : 0;
        r->report->seconds = time_seconds() - r->start;
        tensor_close(base);
        base = done && next < r->end ? tensor_open(r->options->output) : NULL;
        done = done && (base || next >= r->end);
    }
    tensor_close(base);
    r->report->samples = next - r->first;
    return done;
}

// Traces a few strips into nothing, to tell how long all would take.
static bool estimate(struct run *r) {
    const uint32_t spp = r->end - r->first, samples = spp < DRY_SAMPLES ? spp : DRY_SAMPLES;
    double start = time_seconds();
    bool done = open_layout(r, NULL, r->first, r->first + samples);
    if (done) {
        const uint32_t all = strip_count(r), n = all < DRY_TILES ? all : DRY_TILES;
        const size_t pixels = (size_t)r->layout.sums.width * (size_t)r->layout.sums.height;
        r->report->seconds = (time_seconds() - start) * spp / samples;
        r->layout.sums.fixed = mem_array(3 * pixels, sizeof(float));
        start = time_seconds();
        trace(r, (all - n) / 2, n, r->first, samples);
        r->report->seconds += (time_seconds() - start) * all / n * spp / samples;
        r->report->samples = spp;
        mem_free(r->layout.sums.fixed);
    }
    polynomial_layout_finish(&r->layout);
    return done;
}

static bool run(struct run *r) {
    const struct polynomial_options *o = r->options;
    struct tensor_file *base = NULL;
    uint32_t next = r->first;
    if (o->tail == TAIL_GEOMETRIC && !polynomial_radius(r->p, o->bounces, r->p->radius))
        return false;
    if (o->dry_run)
        return estimate(r);
    r->quantum = polynomial_quantum(r->p);
    if (o->resume && !polynomial_resume(r->p, o, r->first, r->quantum, &base, &next))
        return false;
    find_albedos(r);
    if (next < r->end)
        return run_passes(r, base, next);
    tensor_close(base);
    r->report->samples = next - r->first;
    return true;
}

bool precompute_polynomial(const struct polynomial_options *o, struct polynomial_report *report) {
    struct polynomial p;
    *report = (struct polynomial_report){0};
    if (!polynomial_open(&p, o))
        return false;
    const struct render_options *render = &p.job.render;
    struct run r = {.start = time_seconds(), .p = &p, .options = o, .report = report, .first = (uint32_t)p.job.film.first,
                    .end = (uint32_t)(render->end + 1) / 2 * 2};
    const bool done = run(&r);
    if (report->stopped && report->samples > 0)
        log_warn("stopped: %s has %" PRIu64 " samples", o->output, report->samples);
    else if (report->stopped)
        log_error("stopped before the tensor was whole: %s is not written", o->output);
    polynomial_close(&p);
    return done;
}
