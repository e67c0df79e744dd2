// SPDX-License-Identifier: Apache-2.0
// Volumes: colours and numbers that vary in space (density, albedo, temperature colours).
//
// A parameter that may vary is a struct volume_ref: a constant, or a volume. Positions are in
// recentred world space. Values are finite; negative ones in files are taken for zero.
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/transform.h"
#include "math/vec.h"

struct volume_ref {
    spectrum value;              // the constant, when volume is NULL
    const struct object *volume; // of a struct volume_type
    bool given;                  // by the file, or by the table's default
};

// Upper bounds of a volume over the cells of a coarse grid. The volume is zero outside the box.
struct volume_bounds {
    struct affine to_local; // world to [0, cells] along each axis
    int cells[3];
    int lanes;              // 1: the same bound for every lane; else SPECTRUM_LANES
    const float *most;      // [z][y][x][lane]
};

struct volume_type {
    struct entry entry;
    // After the parameters are filled; origin: the point of the file's world that is the origin
    // now; subtract it. false after an error message.
    bool (*prepare)(struct object *self, const double origin[3], struct arena *arena);
    spectrum (*eval)(const void *data, vec3 p);
    spectrum (*maximum)(const void *data); // no value is larger, lane by lane
    // NULL function or result: constant everywhere.
    const struct volume_bounds *(*bounds)(const void *data);
    // Calls visit for the voxels that the ray o + t d, t0 < t < t1, runs through: within (a, b) every
    // lane is a cubic polynomial of t at most. NULL: constant everywhere.
    void (*pieces)(const void *data, vec3 o, vec3 d, float t0, float t1,
                   void (*visit)(void *user, double a, double b), void *user);
    size_t (*bytes)(const void *data); // held in memory; NULL: none worth counting
    void (*finish)(void *data);        // NULL: nothing to do
};

#define X(name) extern const struct volume_type volume_##name;
#include "volume/list.h"
#undef X

extern const struct registry volumes;

static inline const struct volume_type *volume_type_of(const struct object *o) {
    return (const struct volume_type *)o->type;
}

static inline spectrum volume_eval(const struct volume_ref *r, vec3 p) {
    return r->volume ? volume_type_of(r->volume)->eval(r->volume->data, p) : r->value;
}

static inline spectrum volume_maximum(const struct volume_ref *r) {
    return r->volume ? volume_type_of(r->volume)->maximum(r->volume->data) : r->value;
}

// NULL: constant everywhere.
const struct volume_bounds *volume_bounds(const struct volume_ref *r);
