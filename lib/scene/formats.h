// SPDX-License-Identifier: Apache-2.0
// Scene formats: each gives one tree of the scene language (reader.h), which is then made into a
// scene. NULL after an error message.
#pragma once

#include "scene/reader.h"

struct xml_node *gltf_scene_tree(struct reader *r, const char *path);
struct xml_node *obj_scene_tree(struct reader *r, const char *path);
struct xml_node *pbrt_scene_tree(struct reader *r, const char *path);
