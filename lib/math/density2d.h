// SPDX-License-Identifier: Apache-2.0
// Densities on the unit square, bilinear between the nodes of a grid, that depend on up to two
// parameters: tables at several values of each, interpolated linearly. Sampling inverts the marginal
// over rows, then the conditional along the row, exactly; both are continuous (Dupuy and Jakob 2018,
// An Adaptive Parameterization for Efficient Material Acquisition and Rendering, section 4).
#pragma once

#include <stddef.h>

#include "base/mem.h"
#include "math/vec.h"

struct density2d {
    int width, height;    // nodes, at least 2 each
    int counts[2];        // slices of the parameters; the second one varies faster
    const float *params[2]; // their values, ascending
    float *data;          // [slice][height][width]; each slice integrates to 1
    float *rows;          // [slice][height - 1]: integral below row y + 1
    float *columns;       // [slice][height][width - 1]: integral along row y up to column x + 1
};

// Copies values >= 0; tables live in the arena, params stay the caller's. A slice that is all zero
// becomes uniform. counts are 1 for parameters that are not used.
void density2d_init(struct density2d *d, const float *values, int width, int height,
                    const int counts[2], const float *const params[2], struct arena *arena);

// Parameter values fixed: which slices are mixed, with what weights.
struct slice_mix {
    int count;
    uint32_t slice[4];
    float weight[4];
};

struct slice_mix slice_mix_at(const int counts[2], const float *const params[2], float p0,
                              float p1);

// The point a uniform one is mapped to, and the density there.
struct vec2 density2d_sample(const struct density2d *d, const struct slice_mix *mix, struct vec2 u,
                             float *pdf);
// The uniform point that is mapped to p, and the density at p.
struct vec2 density2d_invert(const struct density2d *d, const struct slice_mix *mix, struct vec2 p,
                             float *pdf);

// Bilinear interpolation of one grid of nodes over the unit square.
float grid_eval(const float *values, int width, int height, struct vec2 p);
// The same between slices, `stride` values apart.
float grid_eval_mix(const float *values, int width, int height, size_t stride,
                    const struct slice_mix *mix, struct vec2 p);
