// SPDX-License-Identifier: Apache-2.0
// The lights of the light loop: what comes from infinitely far away, as triangles.
#pragma once

#include "light/light_triangles.h"
#include "world/world.h"

// Lights first <= i < end of the hierarchical order: the triangles that a list of `end` has and one
// of `first` has not, and those that were split for them, with negative power. first 0: all of them.
void edit_sky_init(struct light_triangles *t, const struct world *w, uint32_t first, uint32_t end,
                   int threads);
