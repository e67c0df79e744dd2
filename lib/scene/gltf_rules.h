// SPDX-License-Identifier: Apache-2.0
// What each object of a glTF file may hold (specification, appendix A, and the extensions'), as
// tables: type, range and number of each property, and which array an index points into.
#pragma once

#include <stdbool.h>

enum gltf_kind { NUMBER, INDEX, COUNT, TEXT, FLAG, OBJECT, OBJECTS, NUMBERS, INDICES, TEXTS, ANY };

struct gltf_object_rule;

struct gltf_rule {
    const char *name;
    enum gltf_kind kind;
    bool required;
    double min, max;              // of numbers; min == max: any
    int least, most;              // items of arrays; most 0: any number
    const char *into;             // INDEX, INDICES: the collection
    const struct gltf_object_rule *of; // OBJECT, OBJECTS
};

struct gltf_object_rule {
    const struct gltf_rule *rules; // ends with a nameless one
    const char *extensions;   // those that may stand here, each between blanks
};

// Extensions whose content is looked at, by where they stand; ends with a nameless one.
struct gltf_extension_rule {
    const char *name;
    const struct gltf_object_rule *where, *of;
};

extern const struct gltf_object_rule gltf_root_rule;
extern const struct gltf_extension_rule gltf_extension_rules[];
// The objects in which extensions of the tables may stand; ends with NULL.
extern const struct gltf_object_rule *const gltf_extensible_rules[];
