// SPDX-License-Identifier: Apache-2.0
#include "driver/render.h"

#include <stdatomic.h>

#include "base/mem.h"
#include "base/thread.h"

enum { PACKET_SIDE = 4 }; // a packet of 16 is a 4x4 block of the absolute pixel grid

static const double PASS_SECONDS = 0.8; // wished length of a pass, so that stopping is quick
static const double STOP_SECONDS = 1.5; // a running pass may take this long after a stop

struct worker {
    struct film_view *view;
    struct trace_context ctx;
    struct closure_stack stack;
};

struct pass {
    const struct object *sensor, *integrator;
    const struct filter_sampler *filter;
    const struct render_options *options;
    const struct film *film;
    struct worker *workers;
    uint32_t first, count; // samples
    atomic_bool abandoned;
    _Atomic double stop_time; // when the stop was first seen; 0: not yet
};

// Groups of sixteen pixels that are traced in one call.
struct batch {
    uint32_t count, most; // lanes
    struct path_start starts[SINK_MOST_LANES];
    float weights[SINK_MOST_LANES];
};

// Adds the sixteen paths of one 4x4 block for one sample.
static void start_paths(const struct pass *p, struct worker *w, int x0, int y0, uint32_t sample,
                        struct batch *b) {
    const struct sensor_type *sensor = sensor_type_of(p->sensor);
    const struct render_options *o = p->options;
    struct sink *sink = w->ctx.sink;
    for (int i = 0; i < SINK_LANES; i++) {
        const uint32_t lane = b->count++;
        const int x = x0 + i % PACKET_SIDE, y = y0 + i / PACKET_SIDE;
        struct sampler s = sampler_start(o->sampler, (uint32_t)x, (uint32_t)y, sample, o->spp,
                                         o->replicates, o->seed);
        const struct vec2 d = filter_sample(p->filter, sampler_2d(&s), &b->weights[lane]);
        const struct vec2 lens = sampler_2d(&s);
        sensor->ray(p->sensor->data, (float)x + 0.5f + d.x, (float)y + 0.5f + d.y, lens,
                    &b->starts[lane].ray);
        b->starts[lane].sampler = s;
        film_view_lane(w->view, (int)lane, x, y, sample);
        sink->type->begin(sink, (int)lane);
    }
}

static void trace_batch(const struct pass *p, struct worker *w, struct batch *b) {
    struct sink *sink = w->ctx.sink;
    w->ctx.lanes = b->count;
    if (b->count)
        integrator_type_of(p->integrator)->trace(p->integrator->data, &w->ctx, b->starts);
    for (uint32_t i = 0; i < b->count; i++)
        sink->type->end(sink, (int)i, b->weights[i]);
    b->count = 0;
}

// Whether the pass is to be given up: a stop was asked for, and finishing takes too long.
static bool give_up(struct pass *p) {
    if (!p->options->stop || !*p->options->stop)
        return false;
    const double now = time_seconds();
    double none = 0;
    atomic_compare_exchange_strong(&p->stop_time, &none, now);
    if (now - atomic_load(&p->stop_time) > STOP_SECONDS)
        atomic_store(&p->abandoned, true);
    return atomic_load(&p->abandoned);
}

static void trace_tile(void *ctx, size_t tile, int index) {
    struct pass *p = ctx;
    struct worker *w = &p->workers[index];
    const uint32_t most = integrator_type_of(p->integrator)->most_lanes;
    struct batch batch = {.count = 0, .most = most ? most : SINK_LANES};
    int x0, y0, x1, y1;
    accel_thread_init();
    if (give_up(p))
        return;
    film_view_open(w->view, (uint32_t)tile);
    film_view_clip(w->view, PACKET_SIDE, &x0, &y0, &x1, &y1);
    for (uint32_t s = p->first; s < p->first + p->count; s++) {
        for (int y = y0; y < y1; y += PACKET_SIDE)
            for (int x = x0; x < x1; x += PACKET_SIDE) {
                start_paths(p, w, x, y, s, &batch);
                if (batch.count == batch.most)
                    trace_batch(p, w, &batch);
            }
        trace_batch(p, w, &batch); // a pixel's samples are added in order
        if (give_up(p))
            return;
    }
    film_view_close(w->view);
}

static struct worker *create_workers(const struct world *world, struct film *film, int threads) {
    struct worker *workers = mem_array((size_t)threads, sizeof *workers);
    for (int i = 0; i < threads; i++) {
        struct worker *w = &workers[i];
        w->view = film_view_create(film);
        w->ctx = (struct trace_context){.world = world, .response = &response_physical,
                                        .sink = film_view_sink(w->view), .stack = &w->stack};
    }
    return workers;
}

static void destroy_workers(struct worker *workers, int threads, struct render_result *r) {
    for (int i = 0; i < threads; i++) {
        const struct trace_context *c = &workers[i].ctx;
        r->rays += c->rays;
        r->shadow_rays += c->shadow_rays;
        r->paths += c->paths;
        r->truncated += c->truncated;
        film_view_destroy(workers[i].view);
    }
    mem_free(workers);
}

static double smaller(double a, double b) {
    return a < b ? a : b;
}

// Length of the next pass: about PASS_SECONDS, never across a block of the film.
static uint32_t pass_length(uint64_t next, const struct render_options *o,
                            double seconds_per_sample, double seconds) {
    const uint64_t to_block = FILM_BLOCK - next % FILM_BLOCK, left = o->end - next;
    const double wished = o->seconds > 0 ? smaller(PASS_SECONDS, o->seconds - seconds) : PASS_SECONDS;
    double most = seconds_per_sample > 0 ? wished / seconds_per_sample : 1;
    most = most < 1 ? 1 : most;
    uint64_t n = to_block < left ? to_block : left;
    if ((double)n > most)
        n = (uint64_t)most;
    return (uint32_t)n;
}

// What the run has come to so far.
struct state {
    double seconds, noise; // noise: at the last whole block; negative: not known
};

// Share of the way to the limit that will be met first. Squared noise falls as one over samples.
static double share_done(const struct render_options *o, const struct film *film,
                         const struct state *s) {
    double share = (double)(film_next(film) - film_first(film)) / (double)(o->end - film_first(film));
    if (o->seconds > 0)
        share = share > s->seconds / o->seconds ? share : s->seconds / o->seconds;
    if (o->noise > 0 && s->noise > 0) {
        const double way = o->noise / s->noise * (o->noise / s->noise);
        share = share > way ? share : way;
    }
    return smaller(share, 1);
}

// Whether to go on. The noise is looked at between blocks only: a rule that may stop after any
// sample would favour pictures that look good by chance.
static bool goes_on(const struct render_options *o, const struct film *film, struct state *s) {
    if (film_next(film) >= o->end || (o->stop && *o->stop))
        return false;
    if (o->seconds > 0 && s->seconds >= o->seconds)
        return false;
    if (o->noise > 0 && film_next(film) % FILM_BLOCK == 0) {
        s->noise = film_noise(film);
        return s->noise < 0 || s->noise > o->noise;
    }
    return true;
}

static bool was_cut_short(const struct render_options *o, const struct film *film, double seconds,
                          double noise) {
    if (o->noise > 0)
        return !(noise >= 0 && noise <= o->noise);
    return film_next(film) < o->end && !(o->seconds > 0 && seconds >= o->seconds);
}

void render(const struct world *world, const struct object *sensor, const struct object *integrator,
            const struct filter_sampler *filter, struct film *film,
            const struct render_options *options, struct render_result *result) {
    const int threads = options->threads > 0 ? options->threads : thread_default_count();
    const double start = time_seconds();
    *result = (struct render_result){0};
    struct pass p = {.sensor = sensor, .integrator = integrator, .filter = filter,
                     .options = options, .film = film,
                     .workers = create_workers(world, film, threads)};
    double per_sample = 0;
    struct state state = {.noise = -1};
    while (goes_on(options, film, &state)) {
        const double pass_start = time_seconds();
        p.first = (uint32_t)film_next(film);
        p.count = pass_length(p.first, options, per_sample, state.seconds);
        thread_for(threads, film_tile_count(film), trace_tile, &p);
        if (atomic_load(&p.abandoned))
            break;
        film_commit(film, p.count);
        state.seconds = time_seconds() - start;
        per_sample = (time_seconds() - pass_start) / p.count;
        if (options->progress)
            options->progress(options->user, share_done(options, film, &state), film);
    }
    result->samples = film_samples(film);
    result->noise = film_noise(film);
    result->stopped = was_cut_short(options, film, state.seconds, result->noise);
    destroy_workers(p.workers, threads, result);
    result->seconds = time_seconds() - start;
}
