// SPDX-License-Identifier: Apache-2.0
// What a scene holds and requires, counted.
#pragma once

#include "scene/scene.h"

// How often an entry of a registry (or a kind of shape) is used.
struct scene_use {
    const char *kind; // "shape", "bsdf", "texture", "light", "sensor", ...
    const char *name; // of the entry
    uint32_t count;
};

struct scene_summary {
    uint64_t triangles, vertices; // as stored
    uint64_t placed_triangles;    // counting those of a group once for each instance
    uint64_t mesh_bytes;          // of vertices, indices and attributes
    uint32_t meshes, quadrics;
    uint32_t groups, instances;
    uint32_t emitting_shapes, other_lights;
    uint32_t meshes_with_normals, meshes_with_uvs, meshes_with_attributes;
    uint32_t textured_parameters; // of materials and lights
    bool recentred;               // the scene's middle is not the origin of its file
    struct scene_use *uses;       // by kind, then in order of appearance; owned
    uint32_t use_count;
};

void scene_summary_init(struct scene_summary *summary, const struct scene *scene);
void scene_summary_finish(struct scene_summary *summary);
