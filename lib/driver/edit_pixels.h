// SPDX-License-Identifier: Apache-2.0
// Which pixels show which objects, in the order of a tensor's lists: regions of 8x8 pixels of the
// absolute grid, in them blocks of 4x4, so that what is worked on together lies together.
#pragma once

#include "integrator/light_loop.h"
#include "sink/sink.h"

enum { EDIT_REGION = 8 };

struct edit_pixels_list {
    uint32_t count;
    uint32_t *pixels; // y * width + x
    float *view;      // theta_o, padded with zeros to whole tiles
    uint32_t *place;  // by pixel of the area: where in the list, or EDIT_NONE
};

struct edit_pixels {
    struct sink_area area;
    int regions_x, regions_y;
    uint32_t object_count;
    struct edit_pixels_list *lists; // by object
};

// Looks through the camera with each worker's loop.
void edit_pixels_init(struct edit_pixels *p, struct light_loop *const *loops, int threads,
                      uint32_t object_count, const struct sink_area *area, int width);
void edit_pixels_finish(struct edit_pixels *p);

static inline uint32_t edit_pixels_regions(const struct edit_pixels *p) {
    return (uint32_t)(p->regions_x * p->regions_y);
}

// Where a pixel stands in the list of an object; UINT32_MAX: it does not, or lies outside.
uint32_t edit_pixels_place(const struct edit_pixels *p, uint32_t object, int x, int y);
// Whether any pixel of the 4x4 block at (x, y) shows an object.
bool edit_pixels_any(const struct edit_pixels *p, int x, int y);
// Regions that show objects: how many; and up to `most` of them, spread evenly.
uint32_t edit_pixels_shown(const struct edit_pixels *p);
uint32_t edit_pixels_spread(const struct edit_pixels *p, uint32_t *regions, uint32_t most);
