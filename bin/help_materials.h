// SPDX-License-Identifier: Apache-2.0
// Names that stand for an index of refraction.
#pragma once

#include <stdbool.h>

void help_list_materials(void);
bool help_material(const char *name); // false, nothing printed: no such material
const char *help_nearest_material(const char *name); // or NULL
