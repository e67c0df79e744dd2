// SPDX-License-Identifier: Apache-2.0
#include "driver/render.h"

#include "base/thread.h"
#include "driver/limits.h"

static const double PASS_SECONDS = 0.8; // wished length of a pass, so that stopping is quick

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

static struct sink *make_sink(void *film) {
    return film_sink(film);
}

// Passes until a limit is met, or, where `block` is set, until a block ends.
static struct tracer_counts run(struct film *film, const struct render_options *options, bool block,
                                struct limits_state *state) {
    const double start = time_seconds();
    struct tracer *tracer = tracer_create(&options->tracer, make_sink, film);
    double per_sample = 0;
    while (!(block && film_next(film) % FILM_BLOCK == 0) && limits_go_on(options, film, state)) {
        const double pass_start = time_seconds();
        const uint32_t first = (uint32_t)film_next(film);
        const uint32_t count = pass_length(first, options, per_sample, state->seconds);
        if (!tracer_run(tracer, 0, film_tile_count(film), first, count))
            break;
        film_commit(film, count);
        state->seconds = time_seconds() - start;
        per_sample = (time_seconds() - pass_start) / count;
        if (options->progress)
            options->progress(options->user, limits_share(options, film, state), film);
    }
    const struct tracer_counts n = tracer_count(tracer);
    tracer_destroy(tracer);
    return n;
}

void render_to_block(struct film *film, const struct render_options *options) {
    struct limits_state state = {.noise = -1};
    if (film_next(film) % FILM_BLOCK)
        run(film, options, true, &state);
}

void render(struct film *film, const struct render_options *options, struct render_result *result) {
    const double start = time_seconds();
    struct limits_state state = {.noise = -1};
    const struct tracer_counts n = run(film, options, false, &state);
    state.noise = film_noise(film);
    *result = (struct render_result){
        .samples = film_samples(film), .noise = state.noise, .seconds = time_seconds() - start,
        .stopped = limits_missed(options, film, &state), .rays = n.rays,
        .shadow_rays = n.shadow_rays, .paths = n.paths, .truncated = n.truncated};
}
