// SPDX-License-Identifier: Apache-2.0
// Textures: colours and scalars that vary over a surface.
//
// A parameter that may be textured is a struct texture_ref: a constant, or a texture. A scene
// without textures therefore runs no texture code. Colours are linear Rec.709 after reading.
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/vec.h"
#include "mesh/mesh.h"

// Where a texture is looked up.
struct texture_point {
    struct vec2 uv;
    const struct mesh *mesh; // NULL: not a mesh
    uint32_t triangle;
    struct vec2 barycentric; // weights of vertices 1 and 2
};

struct texture_ref {
    spectrum value;               // the constant, when texture is NULL
    const struct object *texture; // of a struct texture_type
};

// What a texture can give, a channel at a time.
struct texture_range {
    spectrum least, most;
};

struct texture_type {
    struct entry entry;
    // After the parameters are filled: reads files, builds tables; memory from the arena or owned
    // until finish. false after an error message.
    bool (*prepare)(struct object *self, struct arena *arena);
    spectrum (*eval)(const void *data, const struct texture_point *at);
    // Sends for what eval will read there. NULL: it is little.
    void (*send_for)(const void *data, const struct texture_point *at);
    // Gradient of the luminance with respect to (u, v), for bump maps. NULL: by finite differences.
    struct vec2 (*gradient)(const void *data, const struct texture_point *at);
    // Mean over the unit square, for sampling decisions and previews.
    spectrum (*mean)(const void *data);
    // Bounds of eval on a mesh (NULL: on another surface).
    struct texture_range (*range)(const void *data, const struct mesh *mesh);
    // In texels. NULL: it has none, and counts as 1 x 1.
    void (*size)(const void *data, int *width, int *height);
    // Of the mesh, which every shape with this texture must have. NULL: none.
    const char *(*attribute)(const void *data);
    // Instead of the surface's (u, v), the attribute is where textures inside are looked up; a
    // surface without it keeps its own.
    bool replaces_uv;
    bool reads_uv; // by itself, rather than by textures inside
    void (*finish)(void *data); // NULL: nothing to do
};

#define X(name) extern const struct texture_type texture_##name;
#include "texture/list.h"
#undef X

extern const struct registry textures;

static inline const struct texture_type *texture_type_of(const struct object *o) {
    return (const struct texture_type *)o->type;
}

static inline spectrum texture_eval(const struct texture_ref *r, const struct texture_point *at) {
    return r->texture ? texture_type_of(r->texture)->eval(r->texture->data, at) : r->value;
}

// A coloured texture as a number is its luminance.
static inline float texture_eval_scalar(const struct texture_ref *r,
                                        const struct texture_point *at) {
    return r->texture ? spectrum_luminance(texture_eval(r, at)) : r->value[0];
}

static inline spectrum texture_mean(const struct texture_ref *r) {
    return r->texture ? texture_type_of(r->texture)->mean(r->texture->data) : r->value;
}

static inline struct texture_range texture_range(const struct texture_ref *r,
                                                 const struct mesh *mesh) {
    return r->texture ? texture_type_of(r->texture)->range(r->texture->data, mesh)
                      : (struct texture_range){r->value, r->value};
}

// Makes the range hold a value, too.
void texture_range_add(struct texture_range *range, spectrum value);
void texture_size(const struct object *texture, int *width, int *height);
struct vec2 texture_gradient(const struct texture_ref *r, const struct texture_point *at);
