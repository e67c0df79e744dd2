// SPDX-License-Identifier: Apache-2.0
// Upper bounds of a grid over coarse cells of about eight voxels a side.
#pragma once

#include "volume/grid.h"
#include "volume/volume.h"

// Which voxels the values between two coordinates of an axis depend on.
struct bounds_source {
    const struct grid *grid;
    const void *user;
    void (*range)(const void *user, int axis, float lo, float hi, int range[2]); // inclusive
    int (*index)(const void *user, int axis, int i); // of a voxel that may lie outside
};

void bounds_build(struct volume_bounds *b, const struct bounds_source *source,
                  const struct affine *to_voxels, struct arena *arena);
spectrum bounds_maximum(const struct volume_bounds *b);
