// SPDX-License-Identifier: Apache-2.0
// Which objects a pixel shows first, and under what angle: a survey that is traced before a tensor is,
// since its lists of pixels must be known by then.
//
// Objects are those of the chains (sink/chain.h), and one more, the last, for surfaces that nobody
// edits. Lists run over the picture row by row, whatever the order in which samples met them.
#pragma once

#include "sink/sink.h"
#include "sink/tile_grid.h"

enum { SEEN_TILE_PIXELS = SINK_TILE * SINK_TILE };

#define SEEN_END UINT32_MAX

struct seen {
    uint32_t object;
    uint32_t at;      // in the object's list of pixels
    uint32_t next;    // of the same pixel, or SEEN_END
    uint32_t base;    // in the list of an earlier tensor, or SEEN_END
    uint32_t samples; // that met it, where the angle is known
    double view;      // sum of angles between its normal and the eye: multiples of 2^-24, so exact
};

struct seen_tile {
    struct seen *seen;
    size_t count, capacity;
    uint32_t first[SEEN_TILE_PIXELS]; // by tile_grid_inside, or SEEN_END
};

struct seen_list {
    uint32_t *pixels; // y * width + x
    float *view;      // mean angle, [tiles of 64][64]
    double *views;    // its sum, and that of samples, [2][tiles of 64][64]
    uint64_t count, lanes; // lanes: 64 times the tiles
};

struct first_seen {
    struct tile_grid grid;
    int width;               // of the whole picture
    uint32_t object_count;   // with the last one
    struct seen_tile *tiles;
    struct seen_list *lists; // by object
};

struct first_seen *first_seen_create(struct sink_area area, int width, uint32_t object_count);
void first_seen_destroy(struct first_seen *f);
struct sink *first_seen_sink(void *first_seen);
// What an earlier tensor of the same picture knows of an object: its list of pixels, and views of it
// or NULL. At most once for each object.
void first_seen_know(struct first_seen *f, uint32_t object, const uint32_t *pixels, uint64_t count,
                     const double *views);
// Makes the lists, when all tiles have been traced.
void first_seen_list(struct first_seen *f);

// The pixel's record of an object, or NULL.
static inline const struct seen *seen_find(const struct seen_tile *t, size_t inside, uint32_t object) {
    for (uint32_t i = t->first[inside]; i != SEEN_END; i = t->seen[i].next)
        if (t->seen[i].object == object)
            return &t->seen[i];
    return NULL;
}
