// SPDX-License-Identifier: Apache-2.0
// One picture by several ranks: blocks of samples, whose tiles any rank sums.
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "driver/limits.h"
#include "driver/ranks.h"

enum { BLOCKS_AHEAD = 2 };   // that may be worked on at a time
enum { UNITS_PER_RANK = 8 }; // of a block, at least

// A block of samples that is being worked on.
struct block {
    uint64_t first;
    uint32_t count, next_tile, tiles_left;
    double *values; // NULL: not begun
};

struct picture {
    const struct render_options *options;
    struct film *film;                 // the whole picture, on rank 0
    struct film *running;              // the rank's own: only ever holds the running pass
    struct tracer *tracer;             // into that
    struct block blocks[BLOCKS_AHEAD]; // in order
    uint32_t least_tiles, most_tiles;  // of a unit
    bool closed;                       // no more units are handed out
    double start;
    struct limits_state state;
};

static struct sink *make_sink(void *film) {
    return film_sink(film);
}

// ---- what to do ---------------------------------------------------------------------------------

// The next block, behind those that were begun. false: there is none.
static bool begin_block(struct picture *p, struct block *b, uint64_t first) {
    const uint64_t end = p->options->end;
    if (first >= end)
        return false;
    *b = (struct block){.first = first,
                        .count = end - first < FILM_BLOCK ? (uint32_t)(end - first) : FILM_BLOCK,
                        .tiles_left = film_tile_count(p->film),
                        .values = mem_array(film_values(p->film), sizeof *b->values)};
    return true;
}

// Tiles of the next unit where `left` are left of a block: ever fewer, since at the end all wait for
// the last unit, but enough for the threads of a rank.
static uint32_t unit_tiles(const struct picture *p, uint32_t left) {
    const uint32_t part = left / (uint32_t)(2 * ranks_count());
    const uint32_t tiles = part < p->most_tiles ? part : p->most_tiles;
    return tiles > p->least_tiles ? tiles : left < p->least_tiles ? left : p->least_tiles;
}

static bool next(void *user, struct ranks_unit *u) {
    struct picture *p = user;
    uint64_t first = film_next(p->film);
    if (p->options->tracer.stop && *p->options->tracer.stop)
        p->closed = true;
    for (int i = 0; i < BLOCKS_AHEAD && !p->closed; i++) {
        struct block *b = &p->blocks[i];
        if (!b->values && !begin_block(p, b, first))
            return false;
        first = b->first + b->count;
        const uint32_t left = film_tile_count(p->film) - b->next_tile;
        if (left == 0)
            continue;
        *u = (struct ranks_unit){b->first, b->count, b->next_tile, unit_tiles(p, left)};
        b->next_tile += u->tiles;
        return true;
    }
    return false;
}

// ---- what was done ------------------------------------------------------------------------------

static struct block *block_of(struct picture *p, const struct ranks_unit *u) {
    for (int i = 0; i < BLOCKS_AHEAD; i++)
        if (p->blocks[i].values && p->blocks[i].first == u->first)
            return &p->blocks[i];
    abort(); // a unit that was never handed out
}

static void take(void *user, const struct ranks_unit *u, uint32_t part, const double *values,
                 size_t count) {
    struct picture *p = user;
    (void)part;
    memcpy(block_of(p, u)->values + u->tile * film_tile_values(p->film), values,
           count * sizeof *values);
}

static bool work(void *user, const struct ranks_unit *u, struct ranks_part *parts, uint32_t *count) {
    struct picture *p = user;
    if (!tracer_run(p->tracer, u->tile, u->tiles, (uint32_t)u->first, u->count))
        return false;
    const struct ranks_part sums = {film_running(p->running, u->tile),
                                    u->tiles * film_tile_values(p->running)};
    if (parts)
        parts[0] = sums;
    else
        take(p, u, 0, sums.values, sums.count);
    *count = 1;
    return true;
}

// Commits finished blocks in order, and asks after each whether to go on.
static void finish(void *user, const struct ranks_unit *u, bool done) {
    struct picture *p = user;
    const struct render_options *o = p->options;
    if (done)
        block_of(p, u)->tiles_left -= u->tiles;
    while (p->blocks[0].values && p->blocks[0].tiles_left == 0 && !p->closed) {
        film_add_block(p->film, p->blocks[0].values, p->blocks[0].count);
        memmove(p->blocks, p->blocks + 1, (BLOCKS_AHEAD - 1) * sizeof *p->blocks);
        p->blocks[BLOCKS_AHEAD - 1] = (struct block){0};
        p->state.seconds = time_seconds() - p->start;
        p->closed = !limits_go_on(o, p->film, &p->state);
        if (o->progress)
            o->progress(o->user, limits_share(o, p->film, &p->state), p->film);
    }
}

// ---- all ----------------------------------------------------------------------------------------

static void report(struct picture *p, struct render_result *result) {
    const struct tracer_counts n = tracer_count(p->tracer);
    uint64_t counts[] = {n.rays, n.shadow_rays, n.paths, n.truncated, film_rejected(p->running)};
    ranks_sum(counts, sizeof counts / sizeof *counts);
    *result = (struct render_result){.noise = -1};
    if (ranks_index() > 0)
        return;
    film_add_rejected(p->film, counts[4]);
    p->state = (struct limits_state){time_seconds() - p->start, film_noise(p->film)};
    *result = (struct render_result){
        .samples = film_samples(p->film), .noise = p->state.noise, .seconds = p->state.seconds,
        .stopped = limits_missed(p->options, p->film, &p->state), .rays = counts[0],
        .shadow_rays = counts[1], .paths = counts[2], .truncated = counts[3]};
}

void ranks_render(struct film *film, const struct render_options *o, struct render_result *result) {
    if (ranks_count() == 1) {
        render(film, o, result);
        return;
    }
    struct picture p = {.options = o, .film = film, .running = film_create_like(film),
                        .start = time_seconds(), .state = {.noise = -1}};
    p.tracer = tracer_create(&o->tracer, make_sink, p.running);
    p.least_tiles = (uint32_t)tracer_threads(p.tracer);
    p.most_tiles = film_tile_count(film) / (uint32_t)(UNITS_PER_RANK * ranks_count());
    if (ranks_index() == 0) {
        render_to_block(film, o); // a short block that was resumed is finished here
        p.closed = !limits_go_on(o, film, &p.state);
    }
    ranks_share(&(struct ranks_work){1, next, work, take, finish, &p});
    report(&p, result);
    for (int i = 0; i < BLOCKS_AHEAD; i++)
        mem_free(p.blocks[i].values);
    tracer_destroy(p.tracer);
    film_destroy(p.running);
}
