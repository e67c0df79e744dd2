// SPDX-License-Identifier: Apache-2.0
// The sink of identities: for each pixel the names that are seen first and the shares of its samples
// that see them, largest first.
#pragma once

#include "sink/tile_grid.h"

enum { MATTE_RANKS = 6 };

struct matte_options {
    struct sink_area area;
    // Number of the name of what is seen.
    uint32_t (*name)(const void *context, const struct sink_surface *seen);
    const void *context;
};

struct matte_pixel {
    uint32_t names[MATTE_RANKS];
    float weights[MATTE_RANKS]; // sums of filter weights; 0: an unused rank
};

struct matte;

struct matte *matte_create(const struct matte_options *options);
void matte_destroy(struct matte *m);
uint32_t matte_tile_count(const struct matte *m);
struct sink *matte_sink(void *matte);
// Pixel of the absolute grid, within the area. All samples come in one visit of its tile.
const struct matte_pixel *matte_at(const struct matte *m, int x, int y);
