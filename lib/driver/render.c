// SPDX-License-Identifier: Apache-2.0
#include "driver/render.h"

#include "base/thread.h"

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
    if (film_next(film) >= o->end || (o->tracer.stop && *o->tracer.stop))
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

static struct sink *make_sink(void *film) {
    return film_sink(film);
}

void render(struct film *film, const struct render_options *options, struct render_result *result) {
    const double start = time_seconds();
    struct tracer *tracer = tracer_create(&options->tracer, make_sink, film);
    struct state state = {.noise = -1};
    double per_sample = 0;
    while (goes_on(options, film, &state)) {
        const double pass_start = time_seconds();
        const uint32_t first = (uint32_t)film_next(film);
        const uint32_t count = pass_length(first, options, per_sample, state.seconds);
        if (!tracer_run(tracer, 0, film_tile_count(film), first, count))
            break;
        film_commit(film, count);
        state.seconds = time_seconds() - start;
        per_sample = (time_seconds() - pass_start) / count;
        if (options->progress)
            options->progress(options->user, share_done(options, film, &state), film);
    }
    const struct tracer_counts n = tracer_count(tracer);
    *result = (struct render_result){
        .samples = film_samples(film), .noise = film_noise(film), .rays = n.rays,
        .shadow_rays = n.shadow_rays, .paths = n.paths, .truncated = n.truncated};
    result->stopped = was_cut_short(options, film, state.seconds, result->noise);
    result->seconds = time_seconds() - start;
    tracer_destroy(tracer);
}
