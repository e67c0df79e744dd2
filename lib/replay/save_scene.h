// SPDX-License-Identifier: Apache-2.0
// Edited materials written back: a copy of a Mitsuba XML scene in which the edited objects have their
// curves from files beside it.
//
// OUT.xml is the scene with one parameter more for each object, `edited`, that names
// OUT-OBJECT.json (curve/form_json.h); materials that were made editable for the tensor become
// editable materials of the same model. A comment before each names the nearest plain material, for
// renderers without curves. Files that the scene refers to are found where it was.
#pragma once

#include "replay/edit.h"

// scene: the file that the tensor was made of. Objects need ids, of materials or shapes, in that
// file itself, and lights with a factor other than 1 an id or `group`. false after an error message.
bool save_scene(const struct edit_tensor *e, const struct edit_light *lights, uint32_t light_count,
                const char *scene, const char *output);
