// SPDX-License-Identifier: Apache-2.0
// What becomes of scenes of other programs: the tables that their readers go by, as `relume help
// format` and the README show them.
#pragma once

// Of glTF.
struct gltf_row {
    const char *name; // in the file
    const char *here; // NULL: a material extension of which the reader warns that it is not used
};

extern const struct gltf_row gltf_rows[]; // ends with NULL

// Print the tables in Markdown.
void gltf_print_table(void);
void mtl_print_table(void);
void pbrt_print_table(void);
