// SPDX-License-Identifier: Apache-2.0
// What the mesh readers share; for files of mesh/ only.
#pragma once

#include "mesh/mesh.h"

// Zeroed positions with the padding a mesh needs.
float (*mesh_alloc_positions(size_t count))[3];

// The last step of each reader, with all arrays filled and indices checked: turns v of texture
// coordinates into 1 - v where `flips`, makes normals unit, and computes those that are missing or
// drops them as the options want. Normals of length zero, in `path` or left so by the reader for
// vertices that have none, take the computed one.
// false after a message when the mesh has no triangles.
bool mesh_complete(struct mesh *m, const char *path, const struct mesh_options *options,
                   bool flips);

// An attribute added to m; its data is zeroed and holds channels * count floats.
// NULL after a warning when one of that name exists.
struct mesh_attribute *mesh_add_attribute(struct mesh *m, const char *path, const char *name,
                                          int channels, size_t count);
