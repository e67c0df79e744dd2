// SPDX-License-Identifier: Apache-2.0
// How many samples each part of a picture gets: adaptive sampling without bias.
//
// A map is made once, from samples that are then forgotten, and does not change while the picture is
// rendered: so the mean of a pixel is not drawn to where it happened to look finished. It holds a
// factor for each 4x4 packet of the absolute pixel grid, in quarters: where a plain picture takes
// `steps` samples a pixel of factor q takes q / 4 of that. A block of 64 steps is then a whole number
// of rounds over 16 replicates for every q, and all that is summed by blocks stays as it is.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/mem.h"

enum { SAMPLE_MAP_PACKET = 4, SAMPLE_MAP_ONE = 4, SAMPLE_MAP_MOST = 64 };

struct sample_map {
    int width, height; // of the picture, in packets
    uint8_t *quarters; // 1 to SAMPLE_MAP_MOST
};

static inline int sample_map_packets(int pixels) {
    return (pixels + SAMPLE_MAP_PACKET - 1) / SAMPLE_MAP_PACKET;
}

// Factor of the packet that pixel (x, y) lies in; NULL: one everywhere.
static inline uint32_t sample_map_at(const struct sample_map *m, int x, int y) {
    const int i = x / SAMPLE_MAP_PACKET, k = y / SAMPLE_MAP_PACKET;
    return m && i < m->width && k < m->height ? m->quarters[k * m->width + i] : SAMPLE_MAP_ONE;
}

// Samples a pixel of that factor has taken after so many steps.
static inline uint64_t sample_map_taken(uint32_t quarters, uint64_t steps) {
    return (steps * quarters + SAMPLE_MAP_ONE - 1) / SAMPLE_MAP_ONE;
}

// Factors proportional to `wish` (one per packet, >= 0), whose mean over the `count` packets with a
// wish of at least 0 is one, none of them below `least` quarters. Negative wishes: not in the
// picture.
void sample_map_fill(struct sample_map *m, const double *wish, uint32_t least);

// A text of one character a packet, and back. false: not such a text.
char *sample_map_text(const struct sample_map *m, struct arena *arena);
bool sample_map_parse(struct sample_map *m, const char *text, int width, int height,
                      struct arena *arena);
