// SPDX-License-Identifier: Apache-2.0
#include "sink/tensor_sums.h"

#include <stdatomic.h>
#include <string.h>

#include "base/mem.h"
#include "sink/ignore.h"

enum { TILE_PIXELS = SINK_TILE * SINK_TILE, HALVES = 2 };

struct tensor_sums {
    struct tensor_sums_options options;
    struct tile_grid grid;
    uint64_t *first; // place of each tile's first pixel in the list
    atomic_ullong rejected;
};

// What a sample found: a coefficient, or all of them for a direction.
struct deposit {
    uint32_t index; // of a coefficient; count: the fixed picture
    spectrum value;
    vec3 wi;        // SOURCE_SH
};

struct tensor_view {
    struct sink sink; // first
    struct tensor_sums *sums;
    uint32_t tile;
    struct sink_area wanted;
    double *cells; // [pixel][half][coefficient, the fixed one last][3]
    struct tensor_lane {
        double *cells; // of pixel and half; NULL: not wanted
        struct deposit *deposits;
        size_t count, capacity;
    } lanes[SINK_MOST_LANES];
};

static size_t cells_per_half(const struct source_basis *b) {
    return 3 * ((size_t)b->count + 1);
}

size_t tensor_sums_worker_bytes(const struct source_basis *basis) {
    return TILE_PIXELS * HALVES * cells_per_half(basis) * sizeof(double);
}

// ---- the samples --------------------------------------------------------------------------------

static void view_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct tensor_view *v = (void *)s;
    v->tile = tile;
    v->wanted = *wanted = tile_grid_area(&v->sums->grid, tile);
    memset(v->cells, 0, tensor_sums_worker_bytes(&v->sums->options.basis));
}

static void view_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    struct tensor_view *v = (void *)s;
    const size_t half = tile_grid_inside(x, y) * HALVES + sample % HALVES;
    v->lanes[lane].cells = sink_area_has(&v->wanted, x, y)
                               ? v->cells + half * cells_per_half(&v->sums->options.basis)
                               : NULL;
}

static void view_begin(struct sink *s, int lane) {
    ((struct tensor_view *)(void *)s)->lanes[lane].count = 0;
}

static void view_add(struct sink *s, int lane, const struct contribution *c) {
    struct tensor_view *v = (void *)s;
    struct tensor_lane *l = &v->lanes[lane];
    const struct source_basis *b = &v->sums->options.basis;
    struct deposit d = {b->count, c->weight * c->emission, c->wi};
    const float wi[3] = {c->wi[0], c->wi[1], c->wi[2]};
    if (b->kind == SOURCE_LIGHTS)
        d.index = c->source < b->light_count ? b->group_of_light[c->source] : b->count;
    else if (c->source == b->environment)
        d.index = b->kind == SOURCE_PIXELS ? latlong_cell(wi, b->width, b->height) : 0;
    mem_grow(&l->deposits, &l->capacity, l->count + 1, sizeof d);
    l->deposits[l->count++] = d;
}

static void add_to(double *cell, spectrum value, double weight) {
    for (int k = 0; k < 3; k++)
        cell[k] += weight * (double)value[k];
}

static void deposit(const struct source_basis *b, double *cells, const struct deposit *d,
                    double weight) {
    double y[SOURCE_MOST_SH];
    if (b->kind != SOURCE_SH || d->index == b->count) {
        add_to(cells + 3 * (size_t)d->index, d->value, weight);
        return;
    }
    spherical_harmonics((double[]){(double)d->wi[0], (double)d->wi[1], (double)d->wi[2]}, b->order, y);
    for (uint32_t i = 0; i < b->count; i++)
        add_to(cells + 3 * (size_t)i, d->value, weight * y[i]);
}

static void view_end(struct sink *s, int lane, float weight) {
    struct tensor_view *v = (void *)s;
    const struct tensor_lane *l = &v->lanes[lane];
    if (!l->cells)
        return;
    for (size_t i = 0; i < l->count; i++)
        if (!spectrum_is_finite(l->deposits[i].value)) {
            atomic_fetch_add(&v->sums->rejected, 1);
            return;
        }
    for (size_t i = 0; i < l->count; i++)
        deposit(&v->sums->options.basis, l->cells, &l->deposits[i], (double)weight);
}

// ---- the tile -----------------------------------------------------------------------------------

static void store(void *values, enum tensor_storage storage, size_t i, double value) {
    if (storage == TENSOR_BF16)
        ((uint16_t *)values)[i] = bf16_from_float((float)value);
    else
        ((float *)values)[i] = (float)value;
}

// Stores the coefficients of the pixel at place `at` of the list.
static void store_pixel(const struct tensor_sums_options *o, uint64_t at, const double *a,
                        const double *b) {
    const uint64_t tile = at / TENSOR_LANES, lane = at % TENSOR_LANES;
    const double scale = 2.0 / o->samples; // of a half
    for (uint32_t c = 0; c < o->basis.count; c++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint64_t i = ((tile * o->basis.count + c) * 3 + k) * TENSOR_LANES + lane;
            store(o->values, o->storage, i, 0.5 * scale * (a[3 * c + k] + b[3 * c + k]));
            store(o->halves, o->storage, i, 0.5 * scale * (a[3 * c + k] - b[3 * c + k]));
        }
}

// Takes a pixel's cells, one channel after the other, to wavelets.
static void transform(const struct source_basis *b, double *cells, double *plane, double *scratch) {
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < b->count; i++)
            plane[i] = cells[3 * i + k];
        wavelet_forward_matrix(b->wavelet, plane, (size_t)b->height, (size_t)b->width, scratch);
        for (uint32_t i = 0; i < b->count; i++)
            cells[3 * i + k] = plane[i];
    }
}

static void transform_tile(struct tensor_view *v) {
    const struct source_basis *b = &v->sums->options.basis;
    const size_t halves = (size_t)TILE_PIXELS * HALVES, half = cells_per_half(b);
    double *plane = mem_array(b->count, sizeof *plane);
    double *scratch = mem_array(2 * (size_t)(b->width + b->height), sizeof *scratch);
    for (size_t i = 0; i < halves; i++)
        transform(b, v->cells + i * half, plane, scratch);
    mem_free(plane);
    mem_free(scratch);
}

static void view_close(struct sink *s) {
    struct tensor_view *v = (void *)s;
    const struct tensor_sums_options *o = &v->sums->options;
    const size_t half = cells_per_half(&o->basis), fixed = 3 * (size_t)o->basis.count;
    uint64_t at = v->sums->first[v->tile];
    if (o->basis.transformed)
        transform_tile(v);
    if (!o->values)
        return;
    for (int y = v->wanted.y0; y < v->wanted.y1; y++)
        for (int x = v->wanted.x0; x < v->wanted.x1; x++, at++) {
            const double *a = v->cells + tile_grid_inside(x, y) * HALVES * half, *b = a + half;
            const size_t pixel = (size_t)y * (size_t)o->width + (size_t)x;
            store_pixel(o, at, a, b);
            for (size_t k = 0; k < 3; k++)
                o->fixed[k * (size_t)o->width * (size_t)o->height + pixel] =
                    (float)((a[fixed + k] + b[fixed + k]) / o->samples);
        }
}

static void view_destroy(struct sink *s) {
    struct tensor_view *v = (void *)s;
    for (int i = 0; i < SINK_MOST_LANES; i++)
        mem_free(v->lanes[i].deposits);
    mem_free(v->cells);
    mem_free(v);
}

static const struct sink_type view_type = {
    .open = view_open, .close = view_close, .place = view_place, .begin = view_begin,
    .add = view_add, .covered = sink_ignore_lane, .end = view_end, .destroy = view_destroy};

struct sink *tensor_sums_sink(void *tensor_sums) {
    struct tensor_view *v = mem_array(1, sizeof *v);
    v->sink = (struct sink){&view_type, false};
    v->sums = tensor_sums;
    v->cells = mem_array(tensor_sums_worker_bytes(&v->sums->options.basis), 1);
    return &v->sink;
}

// ---- all tiles ----------------------------------------------------------------------------------

struct tensor_sums *tensor_sums_create(const struct tensor_sums_options *options) {
    struct tensor_sums *t = mem_array(1, sizeof *t);
    t->options = *options;
    t->grid = tile_grid_over(options->area);
    const uint32_t tiles = tile_grid_count(&t->grid);
    t->first = mem_array((size_t)tiles + 1, sizeof *t->first);
    for (uint32_t i = 0; i < tiles; i++) {
        const struct sink_area a = tile_grid_area(&t->grid, i);
        t->first[i + 1] = t->first[i] + (uint64_t)(a.x1 - a.x0) * (uint64_t)(a.y1 - a.y0);
    }
    return t;
}

void tensor_sums_destroy(struct tensor_sums *t) {
    if (!t)
        return;
    mem_free(t->first);
    mem_free(t);
}

uint32_t tensor_sums_tile_count(const struct tensor_sums *t) {
    return tile_grid_count(&t->grid);
}

uint64_t tensor_sums_rejected(const struct tensor_sums *t) {
    return atomic_load(&t->rejected);
}

void tensor_sums_pixels(const struct tensor_sums_options *options, uint32_t *pixels) {
    const struct tile_grid grid = tile_grid_over(options->area);
    for (uint32_t i = 0; i < tile_grid_count(&grid); i++) {
        const struct sink_area a = tile_grid_area(&grid, i);
        for (int y = a.y0; y < a.y1; y++)
            for (int x = a.x0; x < a.x1; x++)
                *pixels++ = (uint32_t)(y * options->width + x);
    }
}
