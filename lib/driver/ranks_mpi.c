// SPDX-License-Identifier: Apache-2.0
#include <mpi.h>

#include "driver/ranks.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/thread.h"
#include "driver/limits.h"
#include "driver/rank_messages.h"

enum { TAG_UNIT, TAG_SUMS, TAG_COUNTS };
enum { UNITS_AHEAD = 2 };   // a rank holds, so that it need not wait for the next one
enum { BLOCKS_AHEAD = 2 };  // that may be worked on at a time
enum { UNITS_PER_RANK = 8 }; // of a block, about
enum { MOST_BYTES = 1 << 30 }; // of a message
enum { NAP = 200 };         // microseconds between looks for messages

// Samples [first, first + count) of tiles [tile, tile + tiles). count == 0: there is no more.
struct unit {
    uint64_t first;
    uint32_t count, tile, tiles;
};

static int rank_index, rank_count = 1;

void ranks_start(void) {
    if (!getenv("OMPI_COMM_WORLD_SIZE") && !getenv("PMI_SIZE"))
        return;
    MPI_Init(NULL, NULL);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_index);
    MPI_Comm_size(MPI_COMM_WORLD, &rank_count);
}

void ranks_finish(void) {
    int begun = 0;
    MPI_Initialized(&begun);
    if (begun)
        MPI_Finalize();
}

int ranks_index(void) {
    return rank_index;
}

int ranks_count(void) {
    return rank_count;
}

// ---- messages -----------------------------------------------------------------------------------

// Bytes of the next piece of a message.
static int piece(size_t size) {
    return size < MOST_BYTES ? (int)size : MOST_BYTES;
}

void rank_send(int rank, int tag, const void *data, size_t size) {
    const char *at = data;
    for (int n; size > 0; at += n, size -= (size_t)n) {
        n = piece(size);
        MPI_Send(at, n, MPI_BYTE, rank, tag, MPI_COMM_WORLD);
    }
}

void rank_receive(int rank, int tag, void *data, size_t size) {
    char *at = data;
    for (int n; size > 0; at += n, size -= (size_t)n) {
        n = piece(size);
        MPI_Recv(at, n, MPI_BYTE, rank, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
}

bool rank_waits(int tag, int *rank) {
    MPI_Status status;
    int there;
    MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &there, &status);
    *rank = there ? status.MPI_SOURCE : 0;
    return there;
}

void ranks_broadcast(void *data, size_t size) {
    char *at = data;
    for (int n; rank_count > 1 && size > 0; at += n, size -= (size_t)n) {
        n = piece(size);
        MPI_Bcast(at, n, MPI_BYTE, 0, MPI_COMM_WORLD);
    }
}

void ranks_sum(uint64_t *values, size_t count) {
    uint64_t *own = mem_array(count, sizeof *own);
    memcpy(own, values, count * sizeof *own);
    if (rank_count > 1)
        MPI_Reduce(own, values, (int)count, MPI_UINT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
    mem_free(own);
}

// ---- work, on every rank ------------------------------------------------------------------------

// A film of the rank's own that only ever holds the running pass.
struct bench {
    struct film *film;
    struct tracer *tracer;
};

static struct sink *make_sink(void *film) {
    return film_sink(film);
}

static struct bench bench_create(const struct film *like, const struct render_options *o) {
    struct bench b = {.film = film_create_like(like)};
    b.tracer = tracer_create(&o->tracer, make_sink, b.film);
    return b;
}

static void bench_destroy(struct bench *b) {
    tracer_destroy(b->tracer);
    film_destroy(b->film);
}

// The unit's sums, tile by tile, or NULL when it was given up.
static const double *work(struct bench *b, const struct unit *u) {
    if (!tracer_run(b->tracer, u->tile, u->tiles, (uint32_t)u->first, u->count))
        return NULL;
    return film_running(b->film, u->tile);
}

struct counts {
    struct tracer_counts traced;
    uint64_t rejected;
};

// A finished unit on its way to rank 0, which takes it in between units of its own: meanwhile the next
// one is worked on.
struct parcel {
    struct unit unit;
    double *sums;
    size_t room; // of sums
    MPI_Request requests[2];
};

static void parcel_wait(struct parcel *p) {
    MPI_Waitall(2, p->requests, MPI_STATUSES_IGNORE);
}

// sums == NULL: the unit was given up.
static void parcel_send(struct parcel *p, const struct unit *u, const double *sums, size_t values) {
    parcel_wait(p);
    p->unit = *u;
    p->unit.count = sums ? u->count : 0;
    MPI_Isend(&p->unit, sizeof p->unit, MPI_BYTE, 0, TAG_SUMS, MPI_COMM_WORLD, &p->requests[0]);
    if (!sums)
        return;
    if (p->room < values) {
        mem_free(p->sums);
        p->sums = mem_array(values, sizeof *p->sums);
        p->room = values;
    }
    memcpy(p->sums, sums, values * sizeof *sums);
    MPI_Isend(p->sums, (int)values, MPI_DOUBLE, 0, TAG_SUMS, MPI_COMM_WORLD, &p->requests[1]);
}

static void help(const struct film *film, const struct render_options *o) {
    struct bench b = bench_create(film, o);
    struct parcel parcels[UNITS_AHEAD];
    for (int i = 0; i < UNITS_AHEAD; i++)
        parcels[i] = (struct parcel){.requests = {MPI_REQUEST_NULL, MPI_REQUEST_NULL}};
    for (int i = 0;; i = (i + 1) % UNITS_AHEAD) {
        struct unit u;
        MPI_Recv(&u, sizeof u, MPI_BYTE, 0, TAG_UNIT, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        if (u.count == 0)
            break;
        parcel_send(&parcels[i], &u, work(&b, &u), u.tiles * film_tile_values(film));
    }
    for (int i = 0; i < UNITS_AHEAD; i++) {
        parcel_wait(&parcels[i]);
        mem_free(parcels[i].sums);
    }
    const struct counts n = {tracer_count(b.tracer), film_rejected(b.film)};
    MPI_Send(&n, sizeof n, MPI_BYTE, 0, TAG_COUNTS, MPI_COMM_WORLD);
    bench_destroy(&b);
}

// ---- coordination, on rank 0 --------------------------------------------------------------------

// A block of samples that is being worked on.
struct block {
    uint64_t first;
    uint32_t count, next_tile, tiles_left;
    double *values; // NULL: not begun
};

struct coordinator {
    struct film *film;
    const struct render_options *options;
    struct block blocks[BLOCKS_AHEAD]; // in order
    uint32_t unit_tiles;
    int *held;   // units by rank
    bool closed; // no more units are handed out
    double start;
    struct limits_state state;
};

// The next block, behind those that were begun. false: there is none.
static bool begin_block(struct coordinator *c, struct block *b, uint64_t first) {
    const uint64_t end = c->options->end;
    if (first >= end)
        return false;
    *b = (struct block){.first = first,
                        .count = end - first < FILM_BLOCK ? (uint32_t)(end - first) : FILM_BLOCK,
                        .tiles_left = film_tile_count(c->film),
                        .values = mem_array(film_values(c->film), sizeof *b->values)};
    return true;
}

static bool next_unit(struct coordinator *c, struct unit *u) {
    uint64_t first = film_next(c->film);
    for (int i = 0; i < BLOCKS_AHEAD && !c->closed; i++) {
        struct block *b = &c->blocks[i];
        if (!b->values && !begin_block(c, b, first))
            return false;
        first = b->first + b->count;
        const uint32_t left = film_tile_count(c->film) - b->next_tile;
        if (left == 0)
            continue;
        *u = (struct unit){b->first, b->count, b->next_tile,
                           left < c->unit_tiles ? left : c->unit_tiles};
        b->next_tile += u->tiles;
        return true;
    }
    return false;
}

// Where the sums of a unit belong.
static double *place_of(struct coordinator *c, const struct unit *u, struct block **block) {
    for (int i = 0; i < BLOCKS_AHEAD; i++)
        if (c->blocks[i].values && c->blocks[i].first == u->first) {
            *block = &c->blocks[i];
            return c->blocks[i].values + u->tile * film_tile_values(c->film);
        }
    abort(); // a unit that was never handed out
}

// Commits finished blocks in order, and asks after each whether to go on.
static void commit(struct coordinator *c) {
    while (c->blocks[0].values && c->blocks[0].tiles_left == 0 && !c->closed) {
        film_add_block(c->film, c->blocks[0].values, c->blocks[0].count);
        memmove(c->blocks, c->blocks + 1, (BLOCKS_AHEAD - 1) * sizeof *c->blocks);
        c->blocks[BLOCKS_AHEAD - 1] = (struct block){0};
        c->state.seconds = time_seconds() - c->start;
        c->closed = !limits_go_on(c->options, c->film, &c->state);
        if (c->options->progress)
            c->options->progress(c->options->user, limits_share(c->options, c->film, &c->state),
                                 c->film);
    }
}

// Hands a rank units until it holds enough.
static void supply(struct coordinator *c, int rank) {
    struct unit u;
    while (c->held[rank] < UNITS_AHEAD && next_unit(c, &u)) {
        MPI_Send(&u, sizeof u, MPI_BYTE, rank, TAG_UNIT, MPI_COMM_WORLD);
        c->held[rank]++;
    }
}

// Takes one finished unit in, if there is one.
static bool receive(struct coordinator *c) {
    MPI_Status status;
    struct block *b;
    struct unit u;
    int there;
    MPI_Iprobe(MPI_ANY_SOURCE, TAG_SUMS, MPI_COMM_WORLD, &there, &status);
    if (!there)
        return false;
    const int rank = status.MPI_SOURCE;
    MPI_Recv(&u, sizeof u, MPI_BYTE, rank, TAG_SUMS, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    c->held[rank]--;
    if (u.count) {
        double *place = place_of(c, &u, &b);
        MPI_Recv(place, (int)(u.tiles * film_tile_values(c->film)), MPI_DOUBLE, rank, TAG_SUMS,
                 MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        b->tiles_left -= u.tiles;
        commit(c);
    }
    supply(c, rank);
    return true;
}

static void work_here(struct coordinator *c, struct bench *bench, const struct unit *u) {
    struct block *b;
    const double *sums = work(bench, u);
    if (!sums)
        return;
    memcpy(place_of(c, u, &b), sums, u->tiles * film_tile_values(c->film) * sizeof *sums);
    b->tiles_left -= u->tiles;
    commit(c);
}

static bool any_held(const struct coordinator *c) {
    for (int i = 1; i < rank_count; i++)
        if (c->held[i])
            return true;
    return false;
}

static void stop_helpers(struct tracer_counts *sum, struct film *film) {
    const struct unit none = {0};
    for (int i = 1; i < rank_count; i++)
        MPI_Send(&none, sizeof none, MPI_BYTE, i, TAG_UNIT, MPI_COMM_WORLD);
    for (int i = 1; i < rank_count; i++) {
        struct counts n;
        MPI_Recv(&n, sizeof n, MPI_BYTE, i, TAG_COUNTS, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        sum->rays += n.traced.rays;
        sum->shadow_rays += n.traced.shadow_rays;
        sum->paths += n.traced.paths;
        sum->truncated += n.traced.truncated;
        film_add_rejected(film, n.rejected);
    }
}

static void coordinate(struct coordinator *c, struct bench *bench) {
    for (int i = 1; i < rank_count; i++)
        supply(c, i);
    for (struct unit u;;) {
        if (c->options->tracer.stop && *c->options->tracer.stop)
            c->closed = true;
        while (receive(c))
            ;
        if (next_unit(c, &u))
            work_here(c, bench, &u);
        else if (any_held(c))
            usleep(NAP);
        else
            return;
    }
}

void ranks_render(struct film *film, const struct render_options *o, struct render_result *result) {
    if (rank_count == 1) {
        render(film, o, result);
        return;
    }
    *result = (struct render_result){.noise = -1};
    if (rank_index > 0) {
        help(film, o);
        return;
    }
    struct coordinator c = {.film = film, .options = o, .start = time_seconds(),
                            .held = mem_array((size_t)rank_count, sizeof *c.held),
                            .state = {.noise = -1}};
    struct bench bench = bench_create(film, o);
    const uint32_t share = film_tile_count(film) / (uint32_t)(UNITS_PER_RANK * rank_count);
    c.unit_tiles = share ? share : 1;
    render_to_block(film, o); // a short block that was resumed is finished here
    c.closed = !limits_go_on(o, film, &c.state);
    coordinate(&c, &bench);
    struct tracer_counts n = tracer_count(bench.tracer);
    film_add_rejected(film, film_rejected(bench.film));
    stop_helpers(&n, film);
    for (int i = 0; i < BLOCKS_AHEAD; i++)
        mem_free(c.blocks[i].values);
    bench_destroy(&bench);
    mem_free(c.held);
    c.state = (struct limits_state){time_seconds() - c.start, film_noise(film)};
    *result = (struct render_result){
        .samples = film_samples(film), .noise = c.state.noise, .seconds = c.state.seconds,
        .stopped = limits_missed(o, film, &c.state), .rays = n.rays, .shadow_rays = n.shadow_rays,
        .paths = n.paths, .truncated = n.truncated};
}
