// SPDX-License-Identifier: Apache-2.0
// Textures that read an attribute of the mesh they lie on, held against the shapes that wear them.
#pragma once

#include "scene/scene.h"

// false after an error message that names the texture, the shape and what its mesh has. Materials
// and lights that no shape has are not asked.
bool world_check_attributes(const struct scene *s);
