// SPDX-License-Identifier: Apache-2.0
// Shapes that are not there: their material lets all light straight through, they bound no medium
// and emit nothing. A world without them is the same, but needs no rays to pass them.
#pragma once

#include "scene/scene.h"

// Makes meshes without triangles of them. They still count towards the size of the scene. Materials
// must be prepared.
void world_drop_unseen(struct scene *s);
