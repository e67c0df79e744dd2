// SPDX-License-Identifier: Apache-2.0
// Light sampling for a place a lane: world_sample_light and world_shadow_ray, lane by lane.
#pragma once

#include "world/world.h"

struct light_lanes {
    struct light_samples s; // but not its emission
    spectrum emission[WIDE_LANES];
    uint32_t light[WIDE_LANES];
    uint32_t delta, late;   // a bit a lane
};

// Puts the samples of these lanes in the place of others.
void light_lanes_merge(uint32_t lanes, const struct light_lanes *from, struct light_lanes *to);

// The lanes of `wanted` that a light may light. u1 as for world_sample_light.
uint32_t world_sample_lights(const struct world *w, uint32_t wanted, const struct wide3 *p,
                             const struct wide3 *side, wide u1, const wide u2[2],
                             struct light_lanes *out);

// Whether there is one light, infinitely far away and not a single direction.
bool world_has_only_a_sky(const struct world *w);
// Whether, further, samples of it are taken for many lanes together, which no place changes.
bool world_lights_are_far(const struct world *w);
// Then those of LIGHT_GROUPS groups of lanes at most, but not p, p_error and n, which are zero. lit: the
// lanes that the light may light.
void world_sample_far(const struct world *w, int groups, const wide u[][2],
                      struct light_samples s[], wide_mask lit[]);

// Shadow rays from surfaces to those samples; t from 0 to *tmax.
void world_shadow_rays(const struct surfaces *s, const struct light_samples *l, struct wide3 *o,
                       struct wide3 *d, wide *tmax);
