// SPDX-License-Identifier: Apache-2.0
// How much light each object has passed on, over all pixels together: of every contribution the objects
// that the chain of its path lists (sink/chain.h: `later`, from the second mark on), as often as it does.
#pragma once

#include "sink/sink.h"
#include "sink/tile_grid.h"

struct object_sums {
    struct tile_grid grid;
    uint32_t objects;
    double (*tiles)[3]; // [tile][object], so that they add up in fixed order
};

struct object_sums *object_sums_create(struct sink_area area, uint32_t objects);
void object_sums_destroy(struct object_sums *s);
struct sink *object_sums_sink(void *object_sums);
// Of all samples, by channel.
void object_sums_of(const struct object_sums *s, uint32_t object, double sum[3]);
