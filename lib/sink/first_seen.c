// SPDX-License-Identifier: Apache-2.0
#include "sink/first_seen.h"

#include <math.h>

#include "base/mem.h"
#include "sink/ignore.h"

enum { LIST_LANES = 64 };

struct seen_view {
    struct sink sink; // first
    struct first_seen *all;
    struct seen_tile *tile;
    struct sink_area wanted;
    struct {
        size_t inside;
        bool wanted, covered;
    } lanes[SINK_MOST_LANES];
    struct chain chains[SINK_MOST_LANES];
};

static void view_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct seen_view *v = (void *)s;
    v->tile = &v->all->tiles[tile];
    v->wanted = *wanted = tile_grid_area(&v->all->grid, tile);
}

static void view_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    struct seen_view *v = (void *)s;
    (void)sample;
    v->lanes[lane].inside = tile_grid_inside(x, y);
    v->lanes[lane].wanted = sink_area_has(&v->wanted, x, y);
}

static void view_begin(struct sink *s, int lane) {
    struct seen_view *v = (void *)s;
    v->lanes[lane].covered = false;
    chain_begin(&v->chains[lane]);
}

static void view_covered(struct sink *s, int lane) {
    ((struct seen_view *)(void *)s)->lanes[lane].covered = true;
}

static struct seen *find_or_add(struct seen_tile *t, size_t inside, uint32_t object) {
    uint32_t *link = &t->first[inside];
    while (*link != SEEN_END) {
        if (t->seen[*link].object == object)
            return &t->seen[*link];
        link = &t->seen[*link].next;
    }
    *link = (uint32_t)t->count; // before the array moves
    mem_grow(&t->seen, &t->capacity, t->count + 1, sizeof *t->seen);
    t->seen[t->count] = (struct seen){.object = object, .next = SEEN_END, .base = SEEN_END};
    return &t->seen[t->count++];
}

static void view_end(struct sink *s, int lane, float weight) {
    struct seen_view *v = (void *)s;
    const struct chain *c = &v->chains[lane];
    (void)weight;
    if (!v->lanes[lane].wanted || !v->lanes[lane].covered)
        return;
    const uint32_t object = c->object == CHAIN_FIXED ? v->all->object_count - 1
                                                     : (uint32_t)c->object;
    struct seen *seen = find_or_add(v->tile, v->lanes[lane].inside, object);
    seen->samples++;
    seen->view += rint((double)c->view * 0x1p24) * 0x1p-24;
}

static void view_destroy(struct sink *s) {
    mem_free(s);
}

static const struct sink_type view_type = {
    .open = view_open, .close = sink_ignore_close, .place = view_place, .begin = view_begin,
    .add = sink_ignore_add, .surface = sink_ignore_surface, .covered = view_covered,
    .end = view_end, .destroy = view_destroy};

struct sink *first_seen_sink(void *first_seen) {
    struct seen_view *v = mem_array(1, sizeof *v);
    v->sink = (struct sink){.type = &view_type, .wants_surface = true, .chains = v->chains};
    v->all = first_seen;
    return &v->sink;
}

struct first_seen *first_seen_create(struct sink_area area, int width, uint32_t object_count) {
    struct first_seen *f = mem_array(1, sizeof *f);
    *f = (struct first_seen){.grid = tile_grid_over(area), .width = width,
                             .object_count = object_count};
    const uint32_t tiles = tile_grid_count(&f->grid);
    f->tiles = mem_array(tiles, sizeof *f->tiles);
    f->lists = mem_array(object_count, sizeof *f->lists);
    for (uint32_t t = 0; t < tiles; t++)
        for (int i = 0; i < SEEN_TILE_PIXELS; i++)
            f->tiles[t].first[i] = SEEN_END;
    return f;
}

void first_seen_destroy(struct first_seen *f) {
    if (!f)
        return;
    for (uint32_t t = 0; t < tile_grid_count(&f->grid); t++)
        mem_free(f->tiles[t].seen);
    for (uint32_t o = 0; o < f->object_count; o++) {
        mem_free(f->lists[o].pixels);
        mem_free(f->lists[o].view);
        mem_free(f->lists[o].views);
    }
    mem_free(f->tiles);
    mem_free(f->lists);
    mem_free(f);
}

static struct seen_tile *tile_at(struct first_seen *f, int x, int y) {
    const struct tile_grid *g = &f->grid;
    return &f->tiles[(y / SINK_TILE - g->tile_y0) * g->tiles_x + x / SINK_TILE - g->tile_x0];
}

void first_seen_know(struct first_seen *f, uint32_t object, const uint32_t *pixels, uint64_t count,
                     const double *views) {
    const uint64_t lanes = (count + LIST_LANES - 1) / LIST_LANES * LIST_LANES;
    for (uint64_t i = 0; i < count; i++) {
        const int x = (int)pixels[i] % f->width, y = (int)pixels[i] / f->width;
        struct seen *s = find_or_add(tile_at(f, x, y), tile_grid_inside(x, y), object);
        s->base = (uint32_t)i;
        s->view += views ? views[i] : 0;
        s->samples += views ? (uint32_t)views[lanes + i] : 0;
    }
}

static void list_pixel(struct first_seen *f, struct seen_tile *t, int x, int y) {
    for (uint32_t i = t->first[tile_grid_inside(x, y)]; i != SEEN_END; i = t->seen[i].next) {
        struct seen *s = &t->seen[i];
        struct seen_list *list = &f->lists[s->object];
        s->at = (uint32_t)list->count++;
        list->pixels[s->at] = (uint32_t)(y * f->width + x);
        list->view[s->at] = s->samples ? (float)(s->view / s->samples) : 0;
        list->views[s->at] = s->view;
        list->views[list->lanes + s->at] = s->samples;
    }
}

void first_seen_list(struct first_seen *f) {
    const uint32_t tiles = tile_grid_count(&f->grid);
    uint64_t *counts = mem_array(f->object_count, sizeof *counts);
    for (uint32_t t = 0; t < tiles; t++)
        for (size_t i = 0; i < f->tiles[t].count; i++)
            counts[f->tiles[t].seen[i].object]++;
    for (uint32_t o = 0; o < f->object_count; o++) {
        struct seen_list *list = &f->lists[o];
        list->lanes = (counts[o] + LIST_LANES - 1) / LIST_LANES * LIST_LANES;
        list->pixels = mem_array(counts[o], sizeof *list->pixels);
        list->view = mem_array(list->lanes, sizeof *list->view);
        list->views = mem_array(2 * list->lanes, sizeof *list->views);
    }
    for (int y = f->grid.area.y0; y < f->grid.area.y1; y++)
        for (int x = f->grid.area.x0; x < f->grid.area.x1; x++)
            list_pixel(f, tile_at(f, x, y), x, y);
    mem_free(counts);
}
