// SPDX-License-Identifier: Apache-2.0
// A texture looked up by another set of coordinates than the surface's own (u, v): by an attribute
// of the mesh with two channels, as models with several UV sets have. Surfaces without the attribute
// keep their own.
#include <string.h>

#include "texture/texture.h"

struct uvmap {
    const char *attribute;
    struct texture_ref texture;
};

static const struct param params[] = {
    {"attribute", PARAM_STRING, offsetof(struct uvmap, attribute), .def = "vertex_uv1", .unit = "",
     .help = "vertex_NAME: two values per vertex of the mesh"},
    {"texture", PARAM_TEXTURE, offsetof(struct uvmap, texture), .unit = "",
     .help = "what is looked up"},
    PARAM_END,
};

static bool prepare(struct object *object, struct arena *arena) {
    const struct uvmap *self = object->data;
    (void)arena;
    if (strncmp(self->attribute, "vertex_", 7) == 0)
        return true;
    log_error_at(object->at, "uvmap: attribute \"%s\" was found, expected vertex_NAME",
                 self->attribute);
    return false;
}

// NULL: the surface has none.
static const struct mesh_attribute *find(const struct uvmap *self, const struct texture_point *at) {
    const struct mesh_attribute *a =
        at->mesh ? mesh_find_attribute(at->mesh, self->attribute) : NULL;
    return a && !a->per_face && a->channels > 1 ? a : NULL;
}

// (value at vertex 0, differences of vertices 1 and 2 to it) of a set of coordinates.
static void corners(const float *uv, int stride, const uint32_t v[3], struct vec2 c[3]) {
    for (int i = 0; i < 3; i++)
        c[i] = (struct vec2){uv[(size_t)v[i] * (size_t)stride], uv[(size_t)v[i] * (size_t)stride + 1]};
    for (int i = 1; i < 3; i++) {
        c[i].x -= c[0].x;
        c[i].y -= c[0].y;
    }
}

static struct texture_point moved(const struct mesh_attribute *a, const struct texture_point *at) {
    struct texture_point to = *at;
    struct vec2 c[3];
    corners(a->data, a->channels, at->mesh->indices[at->triangle], c);
    to.uv.x = c[0].x + at->barycentric.x * c[1].x + at->barycentric.y * c[2].x;
    to.uv.y = c[0].y + at->barycentric.x * c[1].y + at->barycentric.y * c[2].y;
    return to;
}

static spectrum eval(const void *data, const struct texture_point *at) {
    const struct uvmap *self = data;
    const struct mesh_attribute *a = find(self, at);
    if (!a)
        return texture_eval(&self->texture, at);
    const struct texture_point to = moved(a, at);
    return texture_eval(&self->texture, &to);
}

// By the chain rule: both sets are linear in the barycentric coordinates of the triangle.
static struct vec2 gradient(const void *data, const struct texture_point *at) {
    const struct uvmap *self = data;
    const struct mesh_attribute *a = find(self, at);
    if (!a)
        return texture_gradient(&self->texture, at);
    const struct texture_point to = moved(a, at);
    const struct vec2 g = texture_gradient(&self->texture, &to);
    struct vec2 own[3] = {{0, 0}, {1, 0}, {0, 1}}, c[3]; // without uvs, (u, v) are barycentric
    const uint32_t *v = at->mesh->indices[at->triangle];
    corners(a->data, a->channels, v, c);
    if (at->mesh->uvs)
        corners(at->mesh->uvs[0], 2, v, own);
    const float det = own[1].x * own[2].y - own[1].y * own[2].x;
    const float along_1 = g.x * c[1].x + g.y * c[1].y, along_2 = g.x * c[2].x + g.y * c[2].y;
    if (det == 0)
        return (struct vec2){0, 0};
    return (struct vec2){(along_1 * own[2].y - along_2 * own[1].y) / det,
                         (along_2 * own[1].x - along_1 * own[2].x) / det};
}

static spectrum mean(const void *data) {
    return texture_mean(&((const struct uvmap *)data)->texture);
}

static struct texture_range range(const void *data, const struct mesh *mesh) {
    return texture_range(&((const struct uvmap *)data)->texture, mesh);
}

static const char *attribute(const void *data) {
    return ((const struct uvmap *)data)->attribute;
}

static void size(const void *data, int *width, int *height) {
    const struct uvmap *self = data;
    *width = *height = 1;
    if (self->texture.texture)
        texture_size(self->texture.texture, width, height);
}

const struct texture_type texture_uvmap = {
    .entry = {.name = "uvmap", .help = "a texture looked up by another set of coordinates",
              .params = params, .size = sizeof(struct uvmap)},
    .prepare = prepare, .eval = eval, .gradient = gradient, .mean = mean,
    .range = range, .attribute = attribute, .replaces_uv = true, .size = size,
};
