// SPDX-License-Identifier: Apache-2.0
#include "driver/tracer.h"

#include <stdatomic.h>

#include "base/mem.h"
#include "base/thread.h"

enum { PACKET_SIDE = 4 }; // a packet of 16 is a 4x4 block of the absolute pixel grid

static const double STOP_SECONDS = 0.25; // of going on after a stop; writing has the rest of two

struct worker {
    struct trace_context ctx;
    struct closure_stack stack;
    struct surface *receivers; // by lane, of a meter of irradiance; NULL: the sensor is a camera
};

struct tracer {
    struct tracer_options options;
    int threads;
    struct worker *workers;
    uint32_t first_tile;
    uint32_t first, count;    // samples of the run
    atomic_bool abandoned;
    atomic_uint closed;       // tiles of the run
    _Atomic double stop_time; // when the stop was first seen; 0: not yet
};

// Groups of sixteen pixels that are traced in one call.
struct batch {
    uint32_t count, most; // lanes
    struct path_start starts[SINK_MOST_LANES];
    float weights[SINK_MOST_LANES];
};

// A place of a meter as a white surface that is looked at along its normal. Returns what turns the
// radiance it sends back into irradiance.
static float receive(const struct sensor_place *place, struct surface *s, struct ray *ray) {
    *s = (struct surface){.p = place->p, .p_error = place->p_error, .ng = place->n,
                          .bsdf = &bsdf_white, .light = SCENE_NONE, .shape = SCENE_NONE,
                          .instance = SCENE_NONE};
    s->point.frame = frame_from_normal(place->n);
    *ray = (struct ray){place->p, -place->n, 0, INFINITY};
    return PI * place->weight;
}

// A film coordinate of a pixel. Rounding can take it to the pixel's end, which belongs to the next,
// and that is another place to a meter.
static float film_point(int pixel, float offset) {
    const float x = (float)pixel + 0.5f + offset, end = (float)pixel + 1;
    return x < end || offset >= 0.5f ? x : nextafterf(end, 0);
}

// The path of one lane through a point of the film; returns its weight.
static float start_path(const struct tracer_options *o, struct worker *w, uint32_t lane, float x,
                        float y, struct vec2 lens, struct path_start *start) {
    const struct sensor_type *sensor = sensor_type_of(o->sensor);
    struct sensor_place place;
    start->surface = NULL;
    if (!sensor->place) {
        sensor->ray(o->sensor->data, x, y, lens, &start->ray);
        return 1;
    }
    sensor->place(o->sensor->data, x, y, &place);
    start->surface = &w->receivers[lane];
    return receive(&place, &w->receivers[lane], &start->ray);
}

// Adds the sixteen paths of one 4x4 block for one sample.
static void start_paths(const struct tracer *t, struct worker *w, int x0, int y0, uint32_t sample,
                        struct batch *b) {
    const struct tracer_options *o = &t->options;
    struct sink *sink = w->ctx.sink;
    const bool has_lens = sensor_type_of(o->sensor)->lens;
    for (int i = 0; i < SINK_LANES; i++) {
        const uint32_t lane = b->count++;
        const int x = x0 + i % PACKET_SIDE, y = y0 + i / PACKET_SIDE;
        struct sampler s = sampler_start(o->sampler, (uint32_t)x, (uint32_t)y, sample, o->spp,
                                         o->replicates, o->seed);
        const struct vec2 d = filter_sample(o->filter, sampler_2d(&s), &b->weights[lane]);
        const uint32_t dimensions = s.dimension; // of a point
        const struct vec2 lens = has_lens ? sampler_2d(&s) : (struct vec2){0, 0};
        s.dimension = 2 * dimensions;
        b->weights[lane] *= start_path(o, w, lane, film_point(x, d.x), film_point(y, d.y), lens,
                                       &b->starts[lane]);
        b->starts[lane].sampler = s;
        sink->type->place(sink, (int)lane, x, y, sample);
        sink->type->begin(sink, (int)lane);
    }
}

static void trace_batch(const struct tracer *t, struct worker *w, struct batch *b) {
    const struct tracer_options *o = &t->options;
    struct sink *sink = w->ctx.sink;
    w->ctx.lanes = b->count;
    if (b->count)
        integrator_type_of(o->integrator)->trace(o->integrator->data, &w->ctx, b->starts);
    for (uint32_t i = 0; i < b->count; i++)
        sink->type->end(sink, (int)i, b->weights[i]);
    b->count = 0;
}

// Whether the pass is to be given up: a stop was asked for, and finishing takes too long.
static bool give_up(struct tracer *t) {
    if (!t->options.stop || !*t->options.stop)
        return false;
    const double now = time_seconds();
    double none = 0;
    atomic_compare_exchange_strong(&t->stop_time, &none, now);
    if (now - atomic_load(&t->stop_time) > STOP_SECONDS)
        atomic_store(&t->abandoned, true);
    return atomic_load(&t->abandoned);
}

// Starts, of the samples that the map has for a step, the `round`th of every packet that has one, and
// traces what fills a batch. false: there was none.
static bool start_round(const struct tracer *t, struct worker *w, const struct sink_area *wanted,
                        uint32_t step, uint32_t round, struct batch *b) {
    const struct sample_map *map = t->options.map;
    const int x0 = wanted->x0 / PACKET_SIDE * PACKET_SIDE;
    const int y0 = wanted->y0 / PACKET_SIDE * PACKET_SIDE;
    bool any = false;
    if (!map && round > 0)
        return false;
    for (int y = y0; y < wanted->y1; y += PACKET_SIDE)
        for (int x = x0; x < wanted->x1; x += PACKET_SIDE) {
            const uint32_t quarters = sample_map_at(map, x, y);
            const uint64_t sample = sample_map_taken(quarters, step) + round;
            if (sample >= sample_map_taken(quarters, (uint64_t)step + 1))
                continue;
            start_paths(t, w, x, y, (uint32_t)sample, b);
            any = true;
            if (b->count == b->most)
                trace_batch(t, w, b);
        }
    return any;
}

static void trace_tile(void *ctx, size_t tile, int index) {
    struct tracer *t = ctx;
    struct worker *w = &t->workers[index];
    struct sink *sink = w->ctx.sink;
    const uint32_t most = integrator_type_of(t->options.integrator)->most_lanes;
    struct batch batch = {.count = 0, .most = most ? most : SINK_LANES};
    struct sink_area wanted;
    accel_thread_init();
    if (give_up(t))
        return;
    sink->type->open(sink, t->first_tile + (uint32_t)tile, &wanted);
    for (uint32_t s = t->first; s < t->first + t->count; s++) {
        for (uint32_t round = 0; start_round(t, w, &wanted, s, round, &batch); round++)
            ;
        if (!t->options.map) // the few packets of later rounds wait for those of the next step
            trace_batch(t, w, &batch);
        if (give_up(t))
            return;
    }
    trace_batch(t, w, &batch);
    sink->type->close(sink);
    const uint32_t closed = atomic_fetch_add(&t->closed, 1) + 1;
    if (index == 0 && t->options.closed)
        t->options.closed(t->options.closed_user, closed);
}

struct tracer *tracer_create(const struct tracer_options *options,
                             struct sink *(*make_sink)(void *context), void *context) {
    struct tracer *t = mem_array(1, sizeof *t);
    t->options = *options;
    t->threads = options->threads > 0 ? options->threads : thread_default_count();
    t->workers = mem_array((size_t)t->threads, sizeof *t->workers);
    for (int i = 0; i < t->threads; i++) {
        struct worker *w = &t->workers[i];
        w->ctx = (struct trace_context){
            .world = options->world, .sink = make_sink(context), .stack = &w->stack,
            .response = options->response ? options->response : &response_physical};
        if (sensor_type_of(options->sensor)->place)
            w->receivers = mem_array(SINK_MOST_LANES, sizeof *w->receivers);
    }
    return t;
}

int tracer_threads(const struct tracer *t) {
    return t->threads;
}

bool tracer_run(struct tracer *t, uint32_t tile, uint32_t tiles, uint32_t first, uint32_t count) {
    t->first_tile = tile;
    t->first = first;
    t->count = count;
    atomic_store(&t->closed, 0);
    thread_for(t->threads, tiles, trace_tile, t);
    return !atomic_load(&t->abandoned);
}

struct tracer_counts tracer_count(const struct tracer *t) {
    struct tracer_counts sum = {0};
    for (int i = 0; i < t->threads; i++) {
        const struct trace_context *c = &t->workers[i].ctx;
        sum.rays += c->rays;
        sum.shadow_rays += c->shadow_rays;
        sum.paths += c->paths;
        sum.truncated += c->truncated;
    }
    return sum;
}

void tracer_destroy(struct tracer *t) {
    for (int i = 0; i < t->threads; i++) {
        struct sink *s = t->workers[i].ctx.sink;
        s->type->destroy(s);
        mem_free(t->workers[i].receivers);
    }
    mem_free(t->workers);
    mem_free(t);
}
