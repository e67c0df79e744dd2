// SPDX-License-Identifier: Apache-2.0
#include "sink/bounce_sums.h"

#include <math.h>

#include "base/mem.h"
#include "sink/ignore.h"

struct sums_view {
    struct sink sink; // first
    struct bounce_sums *all;
    double (*tile)[3];
    struct sink_area wanted;
    bool inside[SINK_MOST_LANES];
};

static void view_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct sums_view *v = (void *)s;
    v->tile = v->all->tiles[tile];
    v->wanted = *wanted = tile_grid_area(&v->all->grid, tile);
}

static void view_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    struct sums_view *v = (void *)s;
    (void)sample;
    v->inside[lane] = sink_area_has(&v->wanted, x, y);
}

static void view_add(struct sink *s, int lane, const struct contribution *c) {
    struct sums_view *v = (void *)s;
    const spectrum value = c->weight * c->emission;
    if (!v->inside[lane] || c->depth >= BOUNCE_SUMS || !spectrum_is_finite(value))
        return;
    for (int k = 0; k < 3; k++)
        v->tile[c->depth][k] += (double)value[k];
}

static void view_destroy(struct sink *s) {
    mem_free(s);
}

static const struct sink_type view_type = {
    .open = view_open, .close = sink_ignore_close, .place = view_place,
    .begin = sink_ignore_lane, .add = view_add, .covered = sink_ignore_lane,
    .end = sink_ignore_end, .destroy = view_destroy};

struct sink *bounce_sums_sink(void *bounce_sums) {
    struct sums_view *v = mem_array(1, sizeof *v);
    v->sink = (struct sink){.type = &view_type};
    v->all = bounce_sums;
    return &v->sink;
}

struct bounce_sums *bounce_sums_create(struct sink_area area) {
    struct bounce_sums *b = mem_array(1, sizeof *b);
    b->grid = tile_grid_over(area);
    b->tiles = mem_array(tile_grid_count(&b->grid), sizeof *b->tiles);
    return b;
}

void bounce_sums_destroy(struct bounce_sums *b) {
    mem_free(b->tiles);
    mem_free(b);
}

void bounce_sums_of(const struct bounce_sums *b, uint32_t events, double sum[3]) {
    for (int k = 0; k < 3; k++) {
        sum[k] = 0;
        for (uint32_t t = 0; t < tile_grid_count(&b->grid); t++)
            sum[k] += b->tiles[t][events][k];
    }
}
