// SPDX-License-Identifier: Apache-2.0
// How much light there is after each number of scattering events, over all pixels together.
#pragma once

#include "sink/sink.h"
#include "sink/tile_grid.h"

enum { BOUNCE_SUMS = 17 }; // light of more scattering events is not counted

struct bounce_sums {
    struct tile_grid grid;
    double (*tiles)[BOUNCE_SUMS][3]; // by tile, so that they add up in fixed order
};

struct bounce_sums *bounce_sums_create(struct sink_area area);
void bounce_sums_destroy(struct bounce_sums *b);
struct sink *bounce_sums_sink(void *bounce_sums);
// Light after `events` scattering events, of all samples, by channel.
void bounce_sums_of(const struct bounce_sums *b, uint32_t events, double sum[3]);
