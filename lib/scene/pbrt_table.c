// SPDX-License-Identifier: Apache-2.0
// What becomes of each type of pbrt, as the rows of a table in Markdown.
#include <stdio.h>
#include <string.h>

#include "scene/format_tables.h"
#include "scene/pbrt.h"

static const struct {
    const char *directive;
    const struct pbrt_row *rows;
} tables[] = {
    {"Shape", pbrt_shapes},        {"Material", pbrt_materials},     {"Texture", pbrt_textures},
    {"LightSource", pbrt_lights},  {"AreaLightSource", pbrt_area_lights},
    {"MakeNamedMedium", pbrt_media}, {"Camera", pbrt_cameras},       {"Film", pbrt_films},
    {"PixelFilter", pbrt_filters}, {"Sampler", pbrt_samplers},       {"Integrator", pbrt_integrators},
};

// Types of one directive that become the same stand in one row.
static void print_rows(const char *directive, const struct pbrt_row *rows) {
    for (const struct pbrt_row *row = rows; row->type; row++) {
        bool printed = false;
        for (const struct pbrt_row *r = rows; r < row; r++)
            printed |= strcmp(r->here, row->here) == 0;
        if (printed)
            continue;
        printf("| %s", directive);
        for (const struct pbrt_row *r = row; r->type; r++)
            if (strcmp(r->here, row->here) == 0)
                printf(" `%s`", *r->type ? r->type : "\"\"");
        printf(" | %s |\n", row->here);
    }
}

void pbrt_print_table(void) {
    printf("| pbrt | here |\n|---|---|\n");
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        print_rows(tables[i].directive, tables[i].rows);
}
