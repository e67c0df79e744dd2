// SPDX-License-Identifier: Apache-2.0
#include "sink/matte.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sink/ignore.h"

enum { MOST_NAMES = 24 }; // of a pixel: the smallest are merged into what is left out

struct matte {
    struct matte_options options;
    struct tile_grid grid;
    struct matte_pixel *pixels; // of the area
};

struct found {
    uint32_t name;
    float weight;
};

struct view {
    struct sink sink; // first, so that a sink is its view
    struct matte *matte;
    struct sink_area wanted;
    struct pixel_names {
        uint32_t count;
        struct found found[MOST_NAMES];
    } *pixels; // of the open tile
    struct view_lane {
        struct pixel_names *pixel; // NULL: not wanted
        uint32_t name;
        bool seen;
    } lanes[SINK_MOST_LANES];
};

struct matte *matte_create(const struct matte_options *options) {
    struct matte *m = mem_array(1, sizeof *m);
    const struct sink_area *a = &options->area;
    m->options = *options;
    m->grid = tile_grid_over(*a);
    m->pixels = mem_array((size_t)(a->x1 - a->x0) * (size_t)(a->y1 - a->y0), sizeof *m->pixels);
    return m;
}

void matte_destroy(struct matte *m) {
    if (m)
        mem_free(m->pixels);
    mem_free(m);
}

uint32_t matte_tile_count(const struct matte *m) {
    return tile_grid_count(&m->grid);
}

static struct matte_pixel *pixel_at(const struct matte *m, int x, int y) {
    const struct sink_area *a = &m->options.area;
    return &m->pixels[(size_t)(y - a->y0) * (size_t)(a->x1 - a->x0) + (size_t)(x - a->x0)];
}

const struct matte_pixel *matte_at(const struct matte *m, int x, int y) {
    return pixel_at(m, x, y);
}

static void view_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct view *v = (void *)s;
    v->wanted = *wanted = tile_grid_area(&v->matte->grid, tile);
    for (int i = 0; i < SINK_TILE * SINK_TILE; i++)
        v->pixels[i].count = 0;
}

// Heavier first; then by name, so that the order does not hang on that of the samples.
static int by_weight(const void *a, const void *b) {
    const struct found *x = a, *y = b;
    if (x->weight != y->weight)
        return x->weight < y->weight ? 1 : -1;
    return (x->name > y->name) - (x->name < y->name);
}

static void view_close(struct sink *s) {
    struct view *v = (void *)s;
    for (int y = v->wanted.y0; y < v->wanted.y1; y++)
        for (int x = v->wanted.x0; x < v->wanted.x1; x++) {
            struct pixel_names *from = &v->pixels[tile_grid_inside(x, y)];
            struct matte_pixel *to = pixel_at(v->matte, x, y);
            qsort(from->found, from->count, sizeof *from->found, by_weight);
            memset(to, 0, sizeof *to);
            for (uint32_t i = 0; i < from->count && i < MATTE_RANKS; i++) {
                to->names[i] = from->found[i].name;
                to->weights[i] = from->found[i].weight > 0 ? from->found[i].weight : 0;
            }
        }
}

static void view_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    struct view *v = (void *)s;
    (void)sample;
    v->lanes[lane].pixel =
        sink_area_has(&v->wanted, x, y) ? &v->pixels[tile_grid_inside(x, y)] : NULL;
}

static void view_begin(struct sink *s, int lane) {
    ((struct view *)(void *)s)->lanes[lane].seen = false;
}

static void view_surface(struct sink *s, int lane, const struct sink_surface *first) {
    struct view *v = (void *)s;
    v->lanes[lane].name = v->matte->options.name(v->matte->options.context, first);
    v->lanes[lane].seen = true;
}

static void view_end(struct sink *s, int lane, float weight) {
    struct view_lane *l = &((struct view *)(void *)s)->lanes[lane];
    if (!l->pixel || !l->seen)
        return;
    uint32_t i = 0;
    while (i < l->pixel->count && l->pixel->found[i].name != l->name)
        i++;
    if (i == MOST_NAMES)
        return;
    if (i == l->pixel->count)
        l->pixel->found[l->pixel->count++] = (struct found){l->name, 0};
    l->pixel->found[i].weight += weight;
}

static void view_destroy(struct sink *s) {
    mem_free(((struct view *)(void *)s)->pixels);
    mem_free(s);
}

static const struct sink_type view_type = {
    .open = view_open, .close = view_close, .place = view_place, .begin = view_begin,
    .add = sink_ignore_add, .surface = view_surface, .covered = sink_ignore_lane,
    .end = view_end, .destroy = view_destroy};

struct sink *matte_sink(void *matte) {
    struct view *v = mem_array(1, sizeof *v);
    v->sink = (struct sink){&view_type, true};
    v->matte = matte;
    v->pixels = mem_array((size_t)SINK_TILE * SINK_TILE, sizeof *v->pixels);
    return &v->sink;
}
