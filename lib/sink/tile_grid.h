// SPDX-License-Identifier: Apache-2.0
// Tiles of SINK_TILE x SINK_TILE pixels that lie on the absolute pixel grid, so that a crop of a
// picture works with the tiles of the whole.
#pragma once

#include <stddef.h>

#include "sink/sink.h"

struct tile_grid {
    struct sink_area area; // pixels that are wanted
    int tile_x0, tile_y0, tiles_x, tiles_y; // in tiles
};

static inline struct tile_grid tile_grid_over(struct sink_area area) {
    const int x0 = area.x0 / SINK_TILE, y0 = area.y0 / SINK_TILE;
    return (struct tile_grid){area, x0, y0, (area.x1 + SINK_TILE - 1) / SINK_TILE - x0,
                              (area.y1 + SINK_TILE - 1) / SINK_TILE - y0};
}

static inline uint32_t tile_grid_count(const struct tile_grid *g) {
    return (uint32_t)(g->tiles_x * g->tiles_y);
}

// The tile that pixel (x, y) of the absolute grid lies in, and its place in that tile.
static inline size_t tile_grid_find(const struct tile_grid *g, int x, int y) {
    return (size_t)((y / SINK_TILE - g->tile_y0) * g->tiles_x + x / SINK_TILE - g->tile_x0);
}

static inline size_t tile_grid_inside(int x, int y) {
    return (size_t)(y % SINK_TILE * SINK_TILE + x % SINK_TILE);
}

static inline bool sink_area_has(const struct sink_area *a, int x, int y) {
    return x >= a->x0 && x < a->x1 && y >= a->y0 && y < a->y1;
}

// The wanted pixels of a tile.
static inline struct sink_area tile_grid_area(const struct tile_grid *g, uint32_t tile) {
    const int x = (g->tile_x0 + (int)tile % g->tiles_x) * SINK_TILE;
    const int y = (g->tile_y0 + (int)tile / g->tiles_x) * SINK_TILE;
    const struct sink_area *a = &g->area;
    return (struct sink_area){x > a->x0 ? x : a->x0, y > a->y0 ? y : a->y0,
                              x + SINK_TILE < a->x1 ? x + SINK_TILE : a->x1,
                              y + SINK_TILE < a->y1 ? y + SINK_TILE : a->y1};
}
