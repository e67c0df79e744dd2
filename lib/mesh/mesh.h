// SPDX-License-Identifier: Apache-2.0
// Triangle meshes as plain arrays, and their readers.
//
// A mesh owns its arrays (mem_free); positions carry three floats of padding at the end because
// ray tracing kernels load 16 bytes. Winding: counter-clockwise seen from the side the geometric
// normal points to. UV origin as Mitsuba has it for each format.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/registry.h"
#include "math/transform.h"

// Extra data a file gives per vertex or per face, as the mesh_attribute texture looks it up: the
// name begins with "vertex_" or "face_".
struct mesh_attribute {
    char name[48];
    int channels; // 1 to 3
    bool per_face;
    float *data; // channels values per vertex or face
};

struct mesh {
    uint32_t vertex_count, triangle_count;
    float (*positions)[3];   // object space as read; world space once a scene is built
    float (*normals)[3];     // per vertex, unit; NULL: none
    bool normals_computed;   // the file gave none: mesh_transform computes them anew
    float (*uvs)[2];         // per vertex; NULL: none
    uint32_t (*indices)[3];
    struct mesh_attribute *attributes;
    uint32_t attribute_count;
};

void mesh_finish(struct mesh *m);
const struct mesh_attribute *mesh_find_attribute(const struct mesh *m, const char *name);
// Positions by the transform, normals by its inverse transpose; a mirroring transform flips the
// winding so that geometric normals stay on the same side as transformed normals. In double.
// false (nothing changed): the transform is singular.
bool mesh_transform(struct mesh *m, const struct transform *to_world);
// Vertex normals as Mitsuba computes them: mean of the unit normals of the faces around a vertex,
// weighted by their angle there (Thuermer and Wuethrich 1998, Computing Vertex Normals from
// Polygonal Facets); (1, 0, 0) where all faces are degenerate. Replaces normals that exist.
void mesh_compute_normals(struct mesh *m);
// Whether all vertex normals are those of the flat triangles, to the rounding of float.
bool mesh_is_flat(const struct mesh *m);

struct mesh_options {
    int shape_index;      // which mesh of a file with several (serialized); else 0
    bool face_normals;    // drop vertex normals
    bool flip_uvs;        // the other way than Mitsuba's default (OBJ: v -> 1 - v; others: as is)
    const char *shape_name; // OBJ: only this group/object; NULL: all
    const char *material_name; // OBJ: only faces of this material, "" for those before the first
                               // usemtl; NULL: all
    int threads;          // 0: default
};

// A file format. `read` reports its own errors and leaves *m empty on failure; every number in the
// file is checked (finite, in range) before it is believed; sizes are checked against the file's
// length before memory is taken for them.
struct mesh_reader_type {
    struct entry entry;             // name: as Mitsuba's shape plugin; params unused
    const char *const *extensions;  // lower case, NULL-terminated
    bool (*read)(const char *path, const struct mesh_options *options, struct mesh *m);
    // How many meshes the file announces, 1 and more, which shape_index counts; false after an
    // error message. NULL: the format has one.
    bool (*count)(const char *path, int *meshes);
};

#define X(name) extern const struct mesh_reader_type mesh_reader_##name;
#include "mesh/list.h"
#undef X

extern const struct registry mesh_readers;
// By the file's extension; NULL after an error message that lists the known ones.
const struct mesh_reader_type *mesh_reader_for(const char *path);

// Meshes of the shapes that are exactly polygonal, as Mitsuba defines them.
void mesh_make_rectangle(struct mesh *m); // [-1,1]^2 at z = 0, normal +z, uv 0..1
void mesh_make_cube(struct mesh *m);      // [-1,1]^3, 24 vertices, normals outwards
