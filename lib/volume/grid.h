// SPDX-License-Identifier: Apache-2.0
// Values on a regular grid, as volume files hold them, and the formats they are read from.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "math/transform.h"

struct grid {
    int size[3];     // voxels along x, y, z; at least 1
    int channels;    // 1 or 3
    float *values;   // [z][y][x][channel], finite and non-negative; mem_free
    // From the unit cube that the voxels fill to the space the file places them in; the identity
    // where it places them nowhere.
    struct transform to_file;
    bool placed;     // the format's grids stand in the world (OpenVDB), whatever the scene says
};

// By the file's extension: .vol (Mitsuba's, version 3) or .vdb (OpenVDB). name: of the grid in a
// file with several, or NULL for the first. false after an error message.
bool grid_read(const char *path, const char *name, struct grid *g);
void grid_finish(struct grid *g);

static inline size_t grid_values(const struct grid *g) {
    return (size_t)g->size[0] * (size_t)g->size[1] * (size_t)g->size[2] * (size_t)g->channels;
}

// ---- for the readers of formats ---------------------------------------------------------------

enum { GRID_MOST_VOXELS = 1 << 30, GRID_MOST_SIDE = 1 << 16 };

// Takes size and channels from the grid and makes room for its values. false after an error message.
bool grid_init(struct grid *g, const char *path);
bool grid_read_vol(const char *path, struct grid *g);
bool grid_read_vdb(const char *path, const char *name, struct grid *g);
