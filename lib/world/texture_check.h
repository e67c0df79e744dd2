// SPDX-License-Identifier: Apache-2.0
// Textures, held against the shapes that wear them and the parameters they stand for.
#pragma once

#include "scene/scene.h"

// Warns, once a texture, of values beyond the range of the parameter, and of shapes without the texture
// coordinates that it is looked up by. false after an error message: a shape's mesh lacks the
// attribute that a texture reads. Materials that no shape wears are not asked.
bool world_check_textures(const struct scene *s);
