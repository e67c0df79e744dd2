// SPDX-License-Identifier: Apache-2.0
#include "sink/edit_sums.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "sink/ignore.h"

enum { HALVES = 2, FIXED_CELLS = 3 };

struct edit_sums {
    struct edit_sums_options options;
    struct tile_grid grid;
    atomic_ullong rejected;
};

struct deposit {
    double *cell;
    spectrum value;
};

struct edit_lane {
    size_t inside;
    uint32_t half;
    bool wanted;
    double *cells; // of the object it sees first, once that is known
    struct deposit *deposits;
    size_t count, capacity;
};

struct edit_view {
    struct sink sink; // first
    struct edit_sums *sums;
    const struct seen_tile *tile;
    uint32_t strip;
    struct sink_area wanted;
    double *cells;          // the fixed picture's [pixel][half][3], then those of the objects
    size_t count, capacity; // of cells
    size_t *start;          // by record of `tile`: its cells [half][place][group][3]
    size_t start_capacity;
    struct edit_lane lanes[SINK_MOST_LANES];
    struct chain chains[SINK_MOST_LANES];
};

static size_t cells_of_half(const struct edit_sums_options *o, uint32_t object) {
    return 3 * (size_t)o->objects[object].places * o->groups;
}

// A strip of a tile.
static struct sink_area strip(const struct edit_sums_options *o, const struct tile_grid *g,
                              uint32_t tile) {
    struct sink_area a = tile_grid_area(g, tile / o->parts);
    const int rows = SINK_TILE / (int)o->parts;
    const int y0 = (g->tile_y0 + (int)(tile / o->parts) / g->tiles_x) * SINK_TILE +
                   (int)(tile % o->parts) * rows;
    a.y0 = a.y0 > y0 ? a.y0 : y0;
    a.y1 = a.y1 < y0 + rows ? a.y1 : y0 + rows;
    if (a.y1 < a.y0)
        a.y1 = a.y0;
    return a;
}

// Lays out the cells of a strip, in `start` where it is not NULL, and returns their number.
static size_t lay_out(const struct edit_sums_options *o, const struct seen_tile *t,
                      const struct sink_area *a, size_t *start) {
    size_t cells = (size_t)SEEN_TILE_PIXELS * HALVES * FIXED_CELLS;
    for (int y = a->y0; y < a->y1; y++)
        for (int x = a->x0; x < a->x1; x++)
            for (uint32_t i = t->first[tile_grid_inside(x, y)]; i != SEEN_END; i = t->seen[i].next) {
                if (start)
                    start[i] = cells;
                cells += HALVES * cells_of_half(o, t->seen[i].object);
            }
    return cells;
}

size_t edit_sums_worker_bytes(const struct edit_sums_options *o) {
    const struct tile_grid grid = tile_grid_over(o->area);
    size_t most = 0;
    for (uint32_t i = 0; i < tile_grid_count(&grid) * o->parts; i++) {
        const struct sink_area a = strip(o, &grid, i);
        const size_t cells = lay_out(o, &o->seen->tiles[i / o->parts], &a, NULL);
        most = cells > most ? cells : most;
    }
    return most * sizeof(double);
}

// ---- the samples ----------------------------------------------------------------------------

static void view_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct edit_view *v = (void *)s;
    const struct edit_sums_options *o = &v->sums->options;
    v->tile = &o->seen->tiles[tile / o->parts];
    v->strip = tile;
    v->wanted = *wanted = strip(o, &v->sums->grid, tile);
    mem_grow(&v->start, &v->start_capacity, v->tile->count, sizeof *v->start);
    v->count = lay_out(o, v->tile, wanted, v->start);
    if (v->count > v->capacity) { // without copying what was there
        mem_free(v->cells);
        v->cells = mem_array(v->count, sizeof *v->cells);
        v->capacity = v->count;
    } else {
        memset(v->cells, 0, v->count * sizeof *v->cells);
    }
}

static void view_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    struct edit_view *v = (void *)s;
    struct edit_lane *l = &v->lanes[lane];
    l->inside = tile_grid_inside(x, y);
    l->half = sample % HALVES;
    l->wanted = sink_area_has(&v->wanted, x, y);
}

static void view_begin(struct sink *s, int lane) {
    struct edit_view *v = (void *)s;
    v->lanes[lane].count = 0;
    v->lanes[lane].cells = NULL;
    chain_begin(&v->chains[lane]);
}

// The cells of what the lane sees first.
static double *cells_of(const struct edit_view *v, struct edit_lane *l, const struct chain *chain) {
    if (l->cells)
        return l->cells;
    const struct edit_sums_options *o = &v->sums->options;
    const uint32_t object =
        chain->object == CHAIN_FIXED ? o->seen->object_count - 1 : (uint32_t)chain->object;
    const struct seen *seen = seen_find(v->tile, l->inside, object);
    assert(seen);
    return l->cells = v->cells + v->start[seen - v->tile->seen] + l->half * cells_of_half(o, object);
}

static double *fixed_cell(const struct edit_view *v, const struct edit_lane *l) {
    return v->cells + (l->inside * HALVES + l->half) * FIXED_CELLS;
}

// Cells are many and met at random: they are fetched while the path goes on.
static void push(struct edit_lane *l, double *cell, spectrum value) {
    __builtin_prefetch(cell, 1);
    mem_grow(&l->deposits, &l->capacity, l->count + 1, sizeof *l->deposits);
    l->deposits[l->count++] = (struct deposit){cell, value};
}

static void view_add(struct sink *s, int lane, const struct contribution *c) {
    struct edit_view *v = (void *)s;
    struct edit_lane *l = &v->lanes[lane];
    const struct edit_sums_options *o = &v->sums->options;
    const struct chain *chain = &v->chains[lane];
    const struct marks *first = &chain->first[c->sampled ? chain->first_of_light : CHAIN_PATH];
    const struct marks *later = &chain->later[c->sampled ? chain->later_of_light : CHAIN_PATH];
    const spectrum gain = c->depth > 0 && c->depth == o->last ? o->gain : spectrum_grey(1);
    const spectrum value = c->weight * c->emission * gain;
    if (!l->wanted)
        return;
    if (chain->object == CHAIN_FIXED && later->mark[0].index == 0) {
        push(l, fixed_cell(v, l), value);
        return;
    }
    double *cells = cells_of(v, l, chain);
    for (uint32_t i = 0; i < first->count; i++)
        for (uint32_t j = 0; j < later->count; j++) {
            const struct mark *p = &first->mark[i], *g = &later->mark[j];
            push(l, cells + 3 * ((size_t)p->index * o->groups + g->index),
                 value * p->weight * g->weight);
        }
}

static void view_end(struct sink *s, int lane, float weight) {
    struct edit_view *v = (void *)s;
    const struct edit_lane *l = &v->lanes[lane];
    for (size_t i = 0; i < l->count; i++)
        if (!spectrum_is_finite(l->deposits[i].value)) {
            atomic_fetch_add(&v->sums->rejected, 1);
            return;
        }
    const double shift = 0x1.8p52 * v->sums->options.quantum; // its unit in the last place: a quantum
    for (size_t i = 0; i < l->count; i++)
        for (int k = 0; k < 3; k++) {
            const double d = (double)weight * (double)l->deposits[i].value[k];
            l->deposits[i].cell[k] += (d + shift) - shift;
        }
}

// ---- the tile -------------------------------------------------------------------------------

static void store(void *values, enum tensor_storage storage, size_t i, double value) {
    if (storage == TENSOR_BF16)
        ((uint16_t *)values)[i] = bf16_from_float((float)value);
    else
        ((float *)values)[i] = (float)value;
}

// Pixels of one object that follow each other in its list, in one tile of 64 of the file.
struct run {
    uint64_t at; // of the first
    size_t count, half; // pixels; cells of one half
    const double *cells[TENSOR_LANES];
    uint32_t base[TENSOR_LANES]; // in the earlier tensor's list
};

struct block_row {
    const struct edit_sums_object *object;
    uint32_t term, channel;
    size_t cell, coefficient;
    uint64_t at; // of the run's first pixel, in the file's arrays
};

// What the earlier tensor has for a run's pixel.
static double earlier(const struct block_row *w, const struct run *r, size_t n, uint32_t half) {
    const struct tensor_block *b = w->object->base[w->term];
    return b && r->base[n] != SEEN_END
               ? b->sums[tensor_sum_at(b, r->base[n], w->coefficient, half, w->channel)]
               : 0;
}

// One coefficient and channel of a run.
static void store_row(const struct edit_sums_options *o, const struct run *r,
                      const struct block_row *w) {
    const double scale = 1.0 / o->samples;
    const struct edit_sums_object *object = w->object;
    const struct tensor_block shape = {.coefficients = o->groups * object->bins[w->term],
                                       .channels = 3};
    double *sums = object->sums[w->term];
    for (size_t n = 0; n < r->count; n++) {
        const double a = r->cells[n][w->cell] + earlier(w, r, n, 0);
        const double b = r->cells[n][r->half + w->cell] + earlier(w, r, n, 1);
        store(object->values[w->term], o->storage, w->at + n, scale * (a + b));
        store(object->halves[w->term], o->storage, w->at + n, scale * (a - b));
        if (!sums)
            continue;
        sums[tensor_sum_at(&shape, r->at + n, w->coefficient, 0, w->channel)] = a;
        sums[tensor_sum_at(&shape, r->at + n, w->coefficient, 1, w->channel)] = b;
    }
}

// Cells lie [place][group][3] and are read in that order; the file has [group][bin][3][64].
static void store_run(const struct edit_sums_options *o, const struct edit_sums_object *object,
                      struct run *r) {
    for (uint32_t t = 0; t < object->terms && r->count > 0; t++) {
        const uint32_t bins = object->bins[t];
        const uint64_t tile = r->at / TENSOR_LANES * o->groups * bins, lane = r->at % TENSOR_LANES;
        for (uint32_t j = 0; j < bins && object->values[t]; j++)
            for (uint32_t g = 0; g < o->groups; g++)
                for (uint32_t k = 0; k < 3; k++) {
                    const struct block_row row = {
                        object, t, k, 3 * ((size_t)(object->first[t] + j) * o->groups + g) + k,
                        (size_t)g * bins + j,
                        ((tile + g * bins + j) * 3 + k) * TENSOR_LANES + lane};
                    store_row(o, r, &row);
                }
    }
    r->count = 0;
}

static void store_object(const struct edit_view *v, uint32_t object) {
    const struct edit_sums_options *o = &v->sums->options;
    struct run r = {.half = cells_of_half(o, object)};
    for (int y = v->wanted.y0; y < v->wanted.y1; y++)
        for (int x = v->wanted.x0; x < v->wanted.x1; x++) {
            const struct seen *seen = seen_find(v->tile, tile_grid_inside(x, y), object);
            if (!seen)
                continue;
            if (seen->at != r.at + r.count || seen->at % TENSOR_LANES == 0)
                store_run(o, &o->objects[object], &r);
            if (r.count == 0)
                r.at = seen->at;
            r.base[r.count] = seen->base;
            r.cells[r.count++] = v->cells + v->start[seen - v->tile->seen];
        }
    store_run(o, &o->objects[object], &r);
}

static void store_fixed(const struct edit_view *v, int x, int y) {
    const struct edit_sums_options *o = &v->sums->options;
    const size_t inside = tile_grid_inside(x, y), plane = (size_t)o->width * (size_t)o->height;
    const double *a = v->cells + inside * HALVES * FIXED_CELLS, *b = a + FIXED_CELLS;
    for (size_t k = 0; k < 3; k++) {
        const size_t at = k * plane + (size_t)y * (size_t)o->width + (size_t)x;
        const double sum = a[k] + b[k] + (o->fixed_base ? o->fixed_base[at] : 0);
        o->fixed[at] = (float)(sum / o->samples);
        if (o->fixed_sums)
            o->fixed_sums[at] = sum;
    }
}

static void hand_over(struct edit_view *v) {
    v->sums->options.handed[v->strip] = (struct edit_sums_cells){v->cells, v->count};
    v->cells = NULL;
    v->capacity = 0;
}

static void view_close(struct sink *s) {
    struct edit_view *v = (void *)s;
    if (v->sums->options.handed) {
        hand_over(v);
        return;
    }
    for (int y = v->wanted.y0; y < v->wanted.y1; y++)
        for (int x = v->wanted.x0; x < v->wanted.x1; x++)
            store_fixed(v, x, y);
    for (uint32_t i = 0; i < v->sums->options.seen->object_count; i++)
        if (v->sums->options.objects[i].places > 0)
            store_object(v, i);
}

static void view_destroy(struct sink *s) {
    struct edit_view *v = (void *)s;
    for (int i = 0; i < SINK_MOST_LANES; i++)
        mem_free(v->lanes[i].deposits);
    mem_free(v->cells);
    mem_free(v->start);
    mem_free(v);
}

static const struct sink_type view_type = {
    .open = view_open, .close = view_close, .place = view_place, .begin = view_begin,
    .add = view_add, .covered = sink_ignore_lane, .end = view_end, .destroy = view_destroy};

struct sink *edit_sums_sink(void *edit_sums) {
    struct edit_view *v = mem_array(1, sizeof *v);
    v->sink = (struct sink){.type = &view_type, .chains = v->chains};
    v->sums = edit_sums;
    return &v->sink;
}

// ---- all tiles ------------------------------------------------------------------------------

struct edit_sums *edit_sums_create(const struct edit_sums_options *options) {
    struct edit_sums *e = mem_array(1, sizeof *e);
    e->options = *options;
    e->grid = tile_grid_over(options->area);
    return e;
}

void edit_sums_destroy(struct edit_sums *e) {
    mem_free(e);
}

uint32_t edit_sums_tile_count(const struct edit_sums *e) {
    return tile_grid_count(&e->grid) * e->options.parts;
}

void edit_sums_take(struct edit_sums *e, uint32_t strip, const double *values, size_t count) {
    struct sink *s = edit_sums_sink(e);
    struct edit_view *v = (void *)s;
    struct sink_area wanted;
    view_open(s, strip, &wanted);
    if (v->count != count) {
        log_error("a process that helps has %zu sums of a strip, expected %zu: it sees another scene",
                  count, v->count);
        abort();
    }
    memcpy(v->cells, values, count * sizeof *values);
    view_close(s);
    view_destroy(s);
}

uint64_t edit_sums_rejected(const struct edit_sums *e) {
    return atomic_load(&e->rejected);
}
