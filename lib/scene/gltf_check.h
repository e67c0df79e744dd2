// SPDX-License-Identifier: Apache-2.0
// The rules of glTF that tie objects together, by subject; for gltf_check*.c only. Each reports its
// first violation and returns false.
#pragma once

#include "scene/gltf.h"

#define EACH(g, collection, i) (size_t i = 0; i < json_count(json_get((g)->root, collection)); i++)

bool gltf_check_views(struct gltf *g);      // buffer views and accessors
bool gltf_check_meshes(struct gltf *g);     // primitives with their materials
bool gltf_check_animations(struct gltf *g); // animations and skins

// Element `index` of the collection, or NULL for -1.
static inline const struct json *gltf_find(const struct gltf *g, const char *collection,
                                           int64_t index) {
    return index < 0 ? NULL : gltf_item(g, collection, (size_t)index);
}
