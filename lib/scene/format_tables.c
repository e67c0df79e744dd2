// SPDX-License-Identifier: Apache-2.0
#include "scene/format_tables.h"

#include "scene/language.h"

struct format_table {
    struct entry entry;
    void (*print)(void);
};

static const struct format_table tables[] = {
    {{.name = "gltf", .help = "models of glTF 2.0, and what becomes of them here"}, gltf_print_table},
    {{.name = "mtl", .help = "materials of OBJ models, and what becomes of them here"}, mtl_print_table},
    {{.name = "pbrt", .help = "scenes of pbrt-v4, and what becomes of them here"}, pbrt_print_table},
};
static const struct entry *const entries[] = {&tables[0].entry, &tables[1].entry, &tables[2].entry,
                                              NULL};
const struct registry scene_formats = {"format", entries};

void scene_print_format(const struct entry *format) {
    ((const struct format_table *)(const void *)format)->print();
}
