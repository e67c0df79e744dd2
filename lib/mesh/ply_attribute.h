// SPDX-License-Identifier: Apache-2.0
// Which properties of a PLY element together make an attribute of the mesh, as Mitsuba 3 names
// them.
//
// r g b (or red green blue) are the attribute "color"; neighbours NAME_0 NAME_1 NAME_2 (or _1 _2
// _3, or _x _y _z) are "NAME", NAME_r NAME_g NAME_b are "NAME_color". Beyond Mitsuba, which skips
// them: two values, and a property without such an ending, which is an attribute of its own name.
#pragma once

#include "mesh/ply_header.h"

struct ply_attribute {
    char name[48];    // with prefix
    int channels;     // 1 to 3
    int property[3];  // into the header's properties
    bool plain;       // integers are values, not shares of their type's range encoded as sRGB
};

// Fills out (room for PLY_MOST_PROPERTIES) from the properties of e that are single values and
// not marked in `used` (indexed like the header's properties), and marks them; returns the count.
// prefix: "vertex_" or "face_".
int ply_group_attributes(const char *path, const struct ply_header *h, const struct ply_element *e,
                         const char *prefix, bool *used, struct ply_attribute *out);
