// SPDX-License-Identifier: Apache-2.0
// The scene language as `relume help` tells it: the tables that the reader itself goes by.
#pragma once

#include "base/registry.h"

// What a scene file may name besides the entries of the registries that the reader is handed.
extern const struct registry scene_shapes, scene_films, scene_spectra;

// Parameters of a shape that is a file of this mesh format.
const struct param *scene_mesh_params(const struct entry *format);

// Prints on standard output what <ELEMENT type="NAME"> means: its parameters with what they take,
// unit, range and default, its other names, and the element as it would stand in a file.
void scene_print_entry(const char *element, const struct entry *e);

// Formats of scenes of which a table says what becomes of what, and that table in Markdown.
extern const struct registry scene_formats;
void scene_print_format(const struct entry *format);
