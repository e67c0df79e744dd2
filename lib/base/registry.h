// SPDX-License-Identifier: Apache-2.0
// Registries and parameter tables: how a BSDF, light, texture, ... says what it is called and
// what a user may set. Readers, --help, documentation and property tests all walk these tables,
// so a new entry is one new file plus one line in its module's list.h.
//
// Every entry struct (struct bsdf_type, ...) begins with a `struct entry`.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"

enum param_type {
    PARAM_BOOL,        // bool
    PARAM_INT,         // int
    PARAM_FLOAT,       // float
    PARAM_CHOICE,      // int: index into choices
    PARAM_STRING,      // const char * (NULL when absent and without default)
    PARAM_FILE,        // const char *: a file found along the search paths
    PARAM_POINT,       // vec3
    PARAM_VECTOR,      // vec3
    PARAM_TRANSFORM,   // struct transform
    PARAM_REFLECTANCE, // spectrum: unitless, usually 0..1; spectra integrate against D65
    PARAM_EMISSION,    // spectrum: emitted quantity; spectra integrate against the CIE observer
    PARAM_INDEX,       // spectrum: unbounded unitless data (index of refraction, density)
    PARAM_TEXTURE,     // struct texture_ref, colour; a constant is read as PARAM_REFLECTANCE
    PARAM_TEXTURE_EMISSION, // struct texture_ref, colour; a constant is read as PARAM_EMISSION
    PARAM_TEXTURE_SCALAR,   // struct texture_ref, lane 0
    PARAM_IOR,         // float: a number or the name of a material (table in math/ior.h)
    PARAM_BSDF,        // const struct object *: child slot
    PARAM_INTEGRATOR,  // const struct object *: child slot
    PARAM_VOLUME,      // struct volume_ref; a constant is read as PARAM_INDEX
    PARAM_PHASE,       // const struct object *: child slot
    PARAM_IGNORED,     // accepted without effect; the reader says so once
};

struct param {
    const char *name;       // as in Mitsuba 3: snake_case; 0.5/0.6's camelCase maps to it
    enum param_type type;
    size_t offset;          // of the value in the instance data
    const char *def;        // default as it would stand in a file; NULL: required (slots, files)
    double min, max;        // range of numbers, inclusive; min == max == 0: any finite number
    const char *unit;       // "" when there is none
    const char *help;       // one line
    const char *const *choices; // PARAM_CHOICE: NULL-terminated names
    const char *aka;        // another name of it in some dialect, or NULL
    bool optional;          // may be absent although there is no default (pointer stays NULL)
};

#define PARAM_END {.name = NULL}

struct entry {
    const char *name;
    const char *help;             // one line, with the source (author year) where there is one
    const char *const *aliases;   // names in other dialects, NULL-terminated; or NULL
    const struct param *params;   // ends with PARAM_END; NULL: none
    size_t size;                  // bytes of instance data that the parameters fill
};

// An instance of an entry, as a reader makes it: data holds entry->size bytes, filled from the
// parameters; the module's prepare function then checks it and builds its tables.
struct object {
    const struct entry *type;
    void *data;
    const char *id;  // name in the file, or NULL
    struct where at; // where it stands in the file
};

struct registry {
    const char *kind;                    // "bsdf", "texture", ... as in messages
    const struct entry *const *entries;  // NULL-terminated
};

// The entry with that name or alias, or NULL.
const struct entry *registry_find(const struct registry *r, const char *name);
// The name (not alias) nearest to a mistyped one, or NULL where nothing is near.
const char *registry_nearest(const struct registry *r, const char *name);
// A line "  name  help" for each entry on standard output.
void registry_print(const struct registry *r);
const struct param *param_find(const struct entry *e, const char *name);
const char *param_nearest(const struct entry *e, const char *name);

// Levenshtein distance; candidate is "near" when the distance is at most a third of its length.
int edit_distance(const char *a, const char *b);
// Keeps the better of two candidates for a mistyped name: *nearest becomes the answer, *best the
// distance, if the candidate is near and nearer. Begin with NULL and any large number.
void name_consider(const char *candidate, const char *answer, const char *name, int *best,
                   const char **nearest);
