// SPDX-License-Identifier: Apache-2.0
// Which values a film keeps per pixel, and where: nothing is kept that nobody asked for.
// Internal to the film.
#pragma once

#include "sink/film.h"

#define LAYOUT_NONE UINT32_MAX

// Slots of the path layers.
enum { PATH_DIRECT = 0, PATH_INDIRECT = 3, PATH_EMISSION = 6, PATH_SLOTS = 7 };
extern const char *const film_path_names[PATH_SLOTS];

// Slots are colours that a sample gathers; a pixel keeps 3 channels a slot, in slot order, then
// the channels that are made at the end of a sample.
struct film_layout {
    uint32_t slots;
    uint32_t beauty_slot, group_slot, path_slot;
    uint32_t clamp_slot; // what is cut off
    uint32_t channels; // doubles per pixel
    uint32_t replicate_channel, moment_channel, alpha_channel;
    uint32_t aov_channel; // first: number of samples that hit something
    uint32_t aovs;        // enum film_aov
};

void film_layout_init(struct film_layout *l, const struct film_options *o);
void film_layout_add_aovs(const struct film_layout *l, double *pixel, const struct sink_surface *s,
                          bool is_first_sample);

// Sums of all channels of pixel (x, y) on the absolute grid, over all samples so far.
void film_pixel(const struct film *f, int x, int y, double *sums);
// The same of its replicates alone: 3 * FILM_REPLICATES sums.
void film_pixel_replicates(const struct film *f, int x, int y, double *sums);
// Samples of a pixel, and of its replicates.
struct film_counts {
    uint64_t all, replicate[FILM_REPLICATES];
};

void film_pixel_counts(const struct film *f, int x, int y, struct film_counts *n);
const struct film_layout *film_get_layout(const struct film *f);
const struct film_options *film_get_options(const struct film *f);
