// SPDX-License-Identifier: Apache-2.0
#include "driver/precompute_polynomial.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "driver/polynomial_describe.h"
#include "driver/polynomial_layout.h"
#include "driver/polynomial_pilot.h"
#include "driver/polynomial_resume.h"
#include "driver/ranks.h"

enum { DRY_TILES = 4, DRY_SAMPLES = 16, BLOCK = 64 };
enum { NEAR = 32 << 20 }; // bytes

struct run {
    struct polynomial *p;
    const struct polynomial_options *options;
    struct polynomial_report *report;
    struct polynomial_layout layout; // of the range that is worked on
    double start, quantum;
    uint32_t first, end; // samples that are asked for
};

static int threads_of(const struct run *r) {
    return r->options->job.threads > 0 ? r->options->job.threads : thread_default_count();
}

// ---- memory -----------------------------------------------------------------------------------

// Cuts tiles into strips until the sums of all threads fit, and those of one, which paths meet at
// random, are near: of fresh pages each costs a fault. false after an error message.
static bool fit_memory(struct run *r) {
    struct edit_sums_options *sums = &r->layout.sums;
    const double most = r->options->most_memory > 0 ? r->options->most_memory : (double)mem_of_machine() / 2;
    for (sums->parts = 1;; sums->parts *= 2) {
        const size_t own = edit_sums_worker_bytes(sums);
        r->report->sums_bytes = (uint64_t)threads_of(r) * own;
        if ((own <= NEAR || sums->parts == EDIT_MOST_PARTS) && (double)r->report->sums_bytes <= most)
            return true;
        if (sums->parts == EDIT_MOST_PARTS)
            break;
    }
    log_error("the sums of %d strips of 4 rows at once take %.3g GB, more than the %.3g GB of "
              "--memory; take fewer --threads, bounces or bins", threads_of(r),
              (double)r->report->sums_bytes * 1e-9, most * 1e-9);
    return false;
}

// ---- tracing ----------------------------------------------------------------------------------

// Samples of some strips; all ranks work on them in units.
struct tracing {
    struct run *run;
    struct edit_sums *sums;
    struct tracer *tracer;
    uint32_t strip, strips, of_unit, first, samples;
    uint32_t handed_out, done; // of the strips, on rank 0
    bool closed;               // no more are handed out
    struct edit_sums_cells *handed; // by strip, on other ranks than 0
};

static uint32_t strip_count(const struct run *r) {
    return tile_grid_count(&r->layout.seen->grid) * r->layout.sums.parts;
}

static void forget_handed(struct tracing *t) {
    for (uint32_t i = 0; t->handed && i < strip_count(t->run); i++) {
        mem_free(t->handed[i].values);
        t->handed[i] = (struct edit_sums_cells){NULL, 0};
    }
}

static bool next(void *user, struct ranks_unit *u) {
    struct tracing *t = user;
    const uint32_t left = t->strips - t->handed_out;
    if (t->closed || left == 0)
        return false;
    *u = (struct ranks_unit){t->first, t->samples, t->strip + t->handed_out,
                             left < t->of_unit ? left : t->of_unit};
    t->handed_out += u->tiles;
    return true;
}

static bool work(void *user, const struct ranks_unit *u, struct ranks_part *parts, uint32_t *count) {
    struct tracing *t = user;
    const volatile sig_atomic_t *stop = t->run->p->tracer.stop;
    forget_handed(t);
    *count = u->tiles;
    if ((stop && *stop) ||
        !tracer_run(t->tracer, u->tile, u->tiles, (uint32_t)u->first, u->count))
        return false;
    for (uint32_t i = 0; i < u->tiles && parts; i++)
        parts[i] = (struct ranks_part){t->handed[u->tile + i].values, t->handed[u->tile + i].count};
    return true;
}

static void take(void *user, const struct ranks_unit *u, uint32_t part, const double *values,
                 size_t count) {
    struct tracing *t = user;
    edit_sums_take(t->sums, u->tile + part, values, count);
}

// How much is done once `strips` of these are.
static void report_share(void *user, uint32_t strips) {
    const struct tracing *t = user;
    const struct run *r = t->run;
    const struct job_options *o = &r->options->job;
    const double done = (double)strips / t->strips;
    double share = (t->first - r->first + t->samples * done) / (r->end - r->first);
    if (o->seconds > 0)
        share = fmax(share, (time_seconds() - r->start) / o->seconds);
    if (o->noise > 0 && r->report->noise > 0)
        share = fmax(share, pow(o->noise / r->report->noise, 2));
    if (r->options->progress)
        r->options->progress(r->options->user, fmin(share, 1));
}

static void finish(void *user, const struct ranks_unit *u, bool whole) {
    struct tracing *t = user;
    t->closed = t->closed || !whole;
    t->done += whole ? u->tiles : 0;
    report_share(t, t->done);
}

static bool trace(struct run *r, uint32_t strip, uint32_t strips, uint32_t first, uint32_t samples) {
    struct tracing t = {.run = r, .strip = strip, .strips = strips, .first = first,
                        .samples = samples,
                        .of_unit = ranks_count() > 1 ? (uint32_t)threads_of(r) : strips};
    struct tracer_options o = r->p->tracer;
    if (ranks_index() > 0 && !r->options->dry_run)
        t.handed = mem_array(strip_count(r), sizeof *t.handed);
    r->layout.sums.handed = t.handed;
    t.sums = edit_sums_create(&r->layout.sums);
    if (ranks_count() == 1) { // one unit: threads that wait for each other at its end wait once
        o.closed = report_share;
        o.closed_user = &t;
    }
    t.tracer = tracer_create(&o, edit_sums_sink, t.sums);
    const struct ranks_work w = {t.of_unit, next, work, take, finish, &t};
    (r->options->dry_run ? ranks_work_alone : ranks_share)(&w);
    const struct tracer_counts n = tracer_count(t.tracer);
    uint64_t counts[3] = {n.paths, n.rays + n.shadow_rays, edit_sums_rejected(t.sums)};
    ranks_sum(counts, 3);
    r->report->paths += counts[0];
    r->report->rays += counts[1];
    r->report->rejected += counts[2];
    forget_handed(&t);
    mem_free(t.handed);
    tracer_destroy(t.tracer);
    edit_sums_destroy(t.sums);
    return ranks_index() > 0 || t.done == strips;
}

// ---- passes -----------------------------------------------------------------------------------

// What rank 0 tells the others of a pass; next == end: there is none.
struct pass {
    uint32_t next, end;
};

static bool open_layout(struct run *r, const struct tensor *base, uint32_t next, uint32_t end) {
    const struct polynomial_range range = {
        .first = next, .end = end, .before = next - r->first, .base = base,
        .keep_sums = r->options->keep, .storage = r->options->storage, .quantum = r->quantum};
    struct polynomial_report *report = r->report;
    if (!polynomial_layout_init(&r->layout, r->p, &range)) {
        report->stopped = r->p->tracer.stop && *r->p->tracer.stop;
        if (!report->stopped)
            log_error("%s: is not of this scene and these options", r->options->output);
        return false;
    }
    report->objects = r->p->plan.count;
    report->groups = r->p->groups.count;
    report->coefficients = 0;
    for (uint32_t i = 0; i < r->layout.tensor.block_count; i++)
        report->coefficients += r->layout.blocks[i].coefficients;
    report->file_bytes = polynomial_layout_bytes(&r->layout);
    return fit_memory(r);
}

// On rank 0, once the survey is done: the file, and to the others in how many strips tiles are cut (0:
// there is nothing to do).
static struct tensor_writer *create(struct run *r, bool good, uint32_t end) {
    struct tensor_writer *w = NULL;
    if (good) {
        struct json *meta = polynomial_describe(r->p, r->options, r->first, end, r->quantum);
        r->layout.tensor.meta = meta;
        w = tensor_create(r->options->output, &r->layout.tensor);
        json_destroy(meta);
    }
    uint32_t parts = w ? r->layout.sums.parts : 0;
    ranks_broadcast(&parts, sizeof parts);
    return w;
}

// Traces samples and writes the tensor of all so far. false after an error message, or stopped.
static bool write_pass(struct run *r, const struct tensor *base, uint32_t next, uint32_t end) {
    struct pass pass = {next, end};
    ranks_broadcast(&pass, sizeof pass);
    bool whole = open_layout(r, base, next, end);
    struct tensor_writer *w = create(r, whole, end);
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

// What the other ranks do.
static void help(struct run *r) {
    for (struct pass pass;;) {
        uint32_t parts;
        ranks_broadcast(&pass, sizeof pass);
        if (pass.next == pass.end)
            return;
        const bool good = open_layout(r, NULL, pass.next, pass.end);
        ranks_broadcast(&parts, sizeof parts);
        r->layout.sums.parts = good ? parts : 1;
        if (parts > 0)
            trace(r, 0, strip_count(r), pass.next, pass.end - pass.next);
        polynomial_layout_finish(&r->layout);
    }
}

// Samples that the noise which is asked for needs, when `done` have left so much.
static double samples_for(double wished, double noise, uint32_t done) {
    const double ratio = noise >= 0 ? noise / wished : HUGE_VAL;
    return ceil(ratio * ratio * done / BLOCK) * BLOCK;
}

// Samples of the next pass: whole blocks, and about as long as the time between checkpoints, or as
// is left, or what lacks to the noise that is asked for, up to as many as there are; first of all a few,
// to see what they cost.
static uint32_t pass_length(const struct run *r, uint32_t done, uint32_t next) {
    const struct polynomial_options *o = r->options;
    const double seconds = r->report->seconds, here = next - r->first;
    const double left = o->job.seconds > 0 ? fmax(o->job.seconds - seconds, 0) : HUGE_VAL;
    const double wished = fmin(o->checkpoint > 0 ? o->checkpoint : HUGE_VAL, left);
    double n = r->end - next;
    if (wished < HUGE_VAL)
        n = fmin(n, done == 0 ? BLOCK : fmin(wished * done / seconds, 4.0 * done));
    if (o->job.noise > 0)
        n = fmin(n, here == 0 ? BLOCK
                              : fmin(samples_for(o->job.noise, r->report->noise, (uint32_t)here) - here,
                                     here));
    n = fmax(floor(n / BLOCK) * BLOCK, BLOCK);
    return n < r->end - next ? (uint32_t)n : r->end - next;
}

// Whether samples up to `next` are not enough.
static bool go_on(struct run *r, uint32_t next) {
    const struct job_options *o = &r->options->job;
    if (next > r->first && o->noise > 0 &&
        (!polynomial_noise(r->options->output, threads_of(r), &r->report->noise) ||
         r->report->noise <= o->noise))
        return false;
    return next < r->end && !(next > r->first && o->seconds > 0 && r->report->seconds >= o->seconds);
}

// Passes from `next` on, each from the tensor that the one before has left.
static bool run_passes(struct run *r, struct tensor_file *base, uint32_t next) {
    const uint32_t from = next;
    bool done = true;
    while (done && go_on(r, next)) {
        const uint32_t n = pass_length(r, next - from, next);
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

// On rank 0.
static bool resume_and_run(struct run *r) {
    const struct polynomial_options *o = r->options;
    struct tensor_file *base = NULL;
    uint32_t next = r->first;
    struct json *meta = polynomial_describe(r->p, o, r->first, r->end, r->quantum);
    const bool good = !o->resume || polynomial_resume(o, meta, r->first, &base, &next);
    json_destroy(meta);
    return good && run_passes(r, base, next);
}

static bool run(struct run *r) {
    const struct pass none = {0, 0};
    if (r->options->tail == TAIL_GEOMETRIC &&
        !polynomial_radius(r->p, r->options->bounces, r->p->radius))
        return false;
    if (r->options->dry_run)
        return estimate(r);
    r->quantum = polynomial_quantum(r->p);
    if (ranks_index() > 0) {
        help(r);
        return true;
    }
    const bool done = resume_and_run(r);
    ranks_broadcast((void *)(uintptr_t)&none, sizeof none);
    return done;
}

bool precompute_polynomial(const struct polynomial_options *o, struct polynomial_report *report) {
    struct polynomial p;
    *report = (struct polynomial_report){.noise = -1};
    if (!polynomial_open(&p, o))
        return false;
    const struct render_options *render = &p.job.render;
    struct run r = {.start = time_seconds(), .p = &p, .options = o, .report = report,
                    .first = (uint32_t)p.job.film.first, .end = (uint32_t)(render->end + 1) / 2 * 2};
    const bool done = run(&r);
    if (report->stopped && report->samples > 0)
        log_warn("stopped: %s has %" PRIu64 " samples", o->output, report->samples);
    else if (report->stopped)
        log_error("stopped before the tensor was whole: %s is not written", o->output);
    if (done && o->job.noise > 0 && !(report->noise <= o->job.noise))
        report->stopped = true;
    polynomial_close(&p);
    return done && !report->stopped;
}
