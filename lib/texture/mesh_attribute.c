// SPDX-License-Identifier: Apache-2.0
// Values that a mesh file gives per vertex (interpolated) or per face.
#include <string.h>

#include "texture/texture.h"

struct mesh_attribute_texture {
    const char *name;
    float scale;
};

static const struct param params[] = {
    {"name", PARAM_STRING, offsetof(struct mesh_attribute_texture, name), .unit = "",
     .help = "vertex_NAME or face_NAME"},
    {"scale", PARAM_FLOAT, offsetof(struct mesh_attribute_texture, scale), .def = "1", .unit = "",
     .help = "factor on the values"},
    PARAM_END,
};

static bool prepare(struct object *object, struct arena *arena) {
    const struct mesh_attribute_texture *self = object->data;
    (void)arena;
    if (strncmp(self->name, "vertex_", 7) == 0 || strncmp(self->name, "face_", 5) == 0)
        return true;
    log_error_at(object->at, "mesh_attribute: name \"%s\" was found, expected vertex_NAME or "
                 "face_NAME", self->name);
    return false;
}

static spectrum load(const struct mesh_attribute *a, uint32_t i) {
    const float *p = a->data + (size_t)i * (size_t)a->channels;
    if (a->channels == 1)
        return spectrum_grey(p[0]);
    return spectrum_rgb(p[0], p[1], a->channels > 2 ? p[2] : 0);
}

// Shapes of a world have the attribute (world_check_textures); any other surface is black.
static spectrum eval(const void *data, const struct texture_point *at) {
    const struct mesh_attribute_texture *self = data;
    const struct mesh_attribute *a = at->mesh ? mesh_find_attribute(at->mesh, self->name) : NULL;
    if (!a)
        return spectrum_grey(0);
    if (a->per_face)
        return self->scale * load(a, at->triangle);
    const uint32_t *v = at->mesh->indices[at->triangle];
    const float b1 = at->barycentric.x, b2 = at->barycentric.y;
    return self->scale * ((1 - b1 - b2) * load(a, v[0]) + b1 * load(a, v[1]) + b2 * load(a, v[2]));
}

// Depends on the mesh, which is not known here.
static spectrum mean(const void *data) {
    const struct mesh_attribute_texture *self = data;
    return spectrum_grey(0.5f * self->scale);
}

static struct texture_range range(const void *data, const struct mesh *mesh) {
    const struct mesh_attribute_texture *self = data;
    const struct mesh_attribute *a = mesh ? mesh_find_attribute(mesh, self->name) : NULL;
    if (!a || mesh->triangle_count == 0)
        return (struct texture_range){spectrum_grey(0), spectrum_grey(0)};
    const uint32_t count = a->per_face ? mesh->triangle_count : mesh->vertex_count;
    struct texture_range range = {self->scale * load(a, 0), self->scale * load(a, 0)};
    for (uint32_t i = 1; i < count; i++)
        texture_range_add(&range, self->scale * load(a, i));
    return range;
}

static const char *attribute(const void *data) {
    return ((const struct mesh_attribute_texture *)data)->name;
}

const struct texture_type texture_mesh_attribute = {
    .entry = {.name = "mesh_attribute", .help = "values given by a mesh per vertex or face",
              .params = params, .size = sizeof(struct mesh_attribute_texture)},
    .prepare = prepare, .eval = eval, .mean = mean, .range = range, .attribute = attribute,
};
