// SPDX-License-Identifier: Apache-2.0
#include "sink/object_sums.h"

#include "base/mem.h"
#include "sink/chain.h"

struct sums_view {
    struct sink sink; // first
    struct object_sums *all;
    double (*tile)[3];
    struct sink_area wanted;
    bool inside[SINK_MOST_LANES];
    struct chain chains[SINK_MOST_LANES];
};

static void view_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct sums_view *v = (void *)s;
    v->tile = v->all->tiles + (size_t)tile * v->all->objects;
    v->wanted = *wanted = tile_grid_area(&v->all->grid, tile);
}

static void view_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    struct sums_view *v = (void *)s;
    (void)sample;
    v->inside[lane] = sink_area_has(&v->wanted, x, y);
}

static void view_begin(struct sink *s, int lane) {
    chain_begin(&((struct sums_view *)(void *)s)->chains[lane]);
}

static void view_add(struct sink *s, int lane, const struct contribution *c) {
    struct sums_view *v = (void *)s;
    const struct marks *met = &v->chains[lane].later[CHAIN_PATH];
    const spectrum value = c->weight * c->emission;
    if (!v->inside[lane] || !spectrum_is_finite(value))
        return;
    for (uint32_t i = 1; i < met->count; i++)
        for (int k = 0; k < 3; k++)
            v->tile[met->mark[i].index][k] += (double)value[k];
}

static void view_covered(struct sink *s, int lane) {
    (void)s, (void)lane;
}

static void view_surface(struct sink *s, int lane, const struct sink_surface *first) {
    (void)s, (void)lane, (void)first;
}

static void view_end(struct sink *s, int lane, float weight) {
    (void)s, (void)lane, (void)weight;
}

static void view_close(struct sink *s) {
    (void)s;
}

static void view_destroy(struct sink *s) {
    mem_free(s);
}

static const struct sink_type view_type = {
    .open = view_open, .close = view_close, .place = view_place, .begin = view_begin, .add = view_add,
    .surface = view_surface, .covered = view_covered, .end = view_end, .destroy = view_destroy};

struct sink *object_sums_sink(void *object_sums) {
    struct sums_view *v = mem_array(1, sizeof *v);
    v->sink = (struct sink){.type = &view_type, .chains = v->chains};
    v->all = object_sums;
    return &v->sink;
}

struct object_sums *object_sums_create(struct sink_area area, uint32_t objects) {
    struct object_sums *s = mem_array(1, sizeof *s);
    s->grid = tile_grid_over(area);
    s->objects = objects;
    s->tiles = mem_array((size_t)tile_grid_count(&s->grid) * objects, sizeof *s->tiles);
    return s;
}

void object_sums_destroy(struct object_sums *s) {
    mem_free(s->tiles);
    mem_free(s);
}

void object_sums_of(const struct object_sums *s, uint32_t object, double sum[3]) {
    for (int k = 0; k < 3; k++) {
        sum[k] = 0;
        for (uint32_t t = 0; t < tile_grid_count(&s->grid); t++)
            sum[k] += s->tiles[(size_t)t * s->objects + object][k];
    }
}
