// SPDX-License-Identifier: Apache-2.0
// Primitives: their attributes, indices, morph targets and what their materials ask of them.
#include <stdio.h>
#include <string.h>

#include "scene/gltf_check.h"

// An attribute of the specification: name, allowed types, whether a number follows.
static const struct semantic {
    const char *name, *types;
    bool numbered;
} semantics[] = {
    {"POSITION", " VEC3 ", false},      {"NORMAL", " VEC3 ", false},
    {"TANGENT", " VEC3 VEC4 ", false},  {"TEXCOORD_", " VEC2 ", true},
    {"COLOR_", " VEC3 VEC4 ", true},    {"JOINTS_", " VEC4 ", true},
    {"WEIGHTS_", " VEC4 ", true},
};

// The number behind its name: 0 for unnumbered ones, -1: not this one.
static int number_of(const struct semantic *s, const char *name) {
    int number, used = 0;
    if (!s->numbered)
        return strcmp(name, s->name) == 0 ? 0 : -1;
    const size_t n = strlen(s->name);
    if (strncmp(name, s->name, n) != 0 || sscanf(name + n, "%3d%n", &number, &used) != 1)
        return -1;
    const bool plain = name[n + (size_t)used] == '\0' && number >= 0 &&
                       (name[n] != '0' || name[n + 1] == '\0');
    return plain ? number : -1;
}

static const struct semantic *semantic_of(const char *name) {
    for (size_t i = 0; i < sizeof semantics / sizeof *semantics; i++)
        if (number_of(&semantics[i], name) >= 0)
            return &semantics[i];
    return NULL;
}

static size_t count_of(const struct json *attributes, const char *prefix) {
    size_t n = 0;
    for (size_t i = 0; i < json_count(attributes); i++)
        n += strncmp(json_key(attributes, i), prefix, strlen(prefix)) == 0;
    return n;
}

static bool check_attribute(struct gltf *g, const struct json *attributes, const char *name,
                            double vertices, const char *at) {
    const struct semantic *s = semantic_of(name);
    double index;
    if (!s && name[0] != '_')
        return gltf_fail(g, at, "is no attribute of glTF");
    if (!json_read_number(json_get(attributes, name), &index) || index != (double)(int64_t)index ||
        index < 0 || index >= (double)json_count(json_get(g->root, "accessors")))
        return gltf_fail(g, at, "names no accessor");
    const struct json *a = gltf_item(g, "accessors", (size_t)index);
    const char *type = json_text(json_get(a, "type"));
    if (s && !strstr(s->types, arena_printf(g->arena, " %s ", type)))
        return gltf_fail(g, at, "is a %s, expected%s", type, s->types);
    if (s && (size_t)number_of(s, name) >= count_of(attributes, s->name))
        return gltf_fail(g, at, "leaves out a smaller number");
    if (gltf_number(a, "count", 0) != vertices)
        return gltf_fail(g, at, "has %.0f elements for %.0f vertices", gltf_number(a, "count", 0),
                         vertices);
    if (s && strcmp(name, "POSITION") == 0 && !(json_get(a, "min") && json_get(a, "max")))
        return gltf_fail(g, at, "is an accessor without min and max");
    return true;
}

static bool check_attributes(struct gltf *g, const struct json *attributes, double vertices,
                             const char *at) {
    if (!json_is_object(attributes) || json_count(attributes) == 0)
        return gltf_fail(g, at, "is not an object with attributes");
    for (size_t i = 0; i < json_count(attributes); i++) {
        const char *name = json_key(attributes, i);
        if (!check_attribute(g, attributes, name, vertices,
                             arena_printf(g->arena, "%s/%s", at, name)))
            return false;
    }
    return true;
}

static bool check_targets(struct gltf *g, const struct json *primitive, double vertices,
                          const char *at) {
    const struct json *targets = json_get(primitive, "targets");
    if (targets && (!json_is_array(targets) || json_count(targets) == 0))
        return gltf_fail(g, at, "has targets that are no array with items");
    for (size_t i = 0; i < json_count(targets); i++) {
        const struct json *target = json_at(targets, i);
        const char *here = arena_printf(g->arena, "%s/targets/%zu", at, i);
        if (!check_attributes(g, target, vertices, here))
            return false;
        for (size_t k = 0; k < json_count(target); k++)
            if (!json_get(json_get(primitive, "attributes"), json_key(target, k)))
                return gltf_fail(g, here, "moves %s, which the primitive lacks",
                                 json_key(target, k));
    }
    return true;
}

static bool check_indices(struct gltf *g, const struct json *primitive, const char *at) {
    const struct json *a = gltf_find(g, "accessors", gltf_index(primitive, "indices"));
    const int64_t type = gltf_index(a, "componentType");
    if (!a)
        return true;
    if (strcmp(json_text(json_get(a, "type")), "SCALAR") != 0 ||
        (type != 5121 && type != 5123 && type != 5125))
        return gltf_fail(g, at, "has indices that are no unsigned whole numbers");
    const int64_t view = gltf_index(a, "bufferView");
    for (size_t i = 0; view >= 0 && i < json_count(json_get(primitive, "attributes")); i++) {
        const struct json *attributes = json_get(primitive, "attributes");
        const struct json *other =
            gltf_find(g, "accessors", gltf_index(attributes, json_key(attributes, i)));
        if (gltf_index(other, "bufferView") == view)
            return gltf_fail(g, at, "has indices and vertices in one buffer view");
    }
    return true;
}

// A texture of the material that asks for a set of texture coordinates beyond `sets`: its key.
static const char *missing_set(const struct json *object, double sets) {
    for (size_t i = 0; i < json_count(object); i++) {
        const char *key = json_key(object, i);
        const struct json *info = json_get(object, key);
        const size_t n = strlen(key);
        if (!json_is_object(info))
            continue;
        const struct json *moved = gltf_extension(info, "KHR_texture_transform");
        const bool texture = n > 7 && strcmp(key + n - 7, "Texture") == 0;
        if (texture && gltf_number(moved, "texCoord", gltf_number(info, "texCoord", 0)) >= sets)
            return key;
    }
    return NULL;
}

static bool check_material(struct gltf *g, const struct json *primitive, const char *at) {
    const struct json *material = gltf_find(g, "materials", gltf_index(primitive, "material"));
    const struct json *attributes = json_get(primitive, "attributes");
    const double sets = (double)count_of(attributes, "TEXCOORD_");
    const char *texture = missing_set(material, sets);
    texture = texture ? texture : missing_set(json_get(material, "pbrMetallicRoughness"), sets);
    if (texture)
        return gltf_fail(g, at, "has too few texture coordinates for its %s", texture);
    if (gltf_extension(material, "KHR_materials_anisotropy") && !json_get(attributes, "TANGENT") &&
        (sets == 0 || !json_get(attributes, "NORMAL")) && !json_get(material, "normalTexture"))
        return gltf_fail(g, at, "has no tangents, and an anisotropic material");
    return true;
}

static bool check_variants(struct gltf *g, const struct json *primitive, const char *at) {
    const struct json *mappings =
        json_get(gltf_extension(primitive, "KHR_materials_variants"), "mappings");
    struct list seen = {0};
    bool ok = true;
    for (size_t i = 0; i < json_count(mappings) && ok; i++) {
        const struct json *variants = json_get(json_at(mappings, i), "variants");
        for (size_t k = 0; k < json_count(variants) && ok; k++) {
            double v;
            json_read_number(json_at(variants, k), &v);
            for (size_t j = 0; j < seen.count && ok; j++)
                ok = LIST_AT(&seen, double, j) != v || gltf_fail(g, at, "has a variant twice");
            *LIST_ADD(&seen, double) = v;
        }
    }
    mem_free(seen.items);
    return ok;
}

static bool check_primitive(struct gltf *g, const struct json *primitive, const char *at) {
    const struct json *attributes = json_get(primitive, "attributes");
    const char *first = json_key(attributes, 0);
    const char *lead = json_get(attributes, "POSITION") || !first ? "POSITION" : first;
    const struct json *a = NULL;
    double index;
    if (json_read_number(json_get(attributes, lead), &index) && index >= 0)
        a = gltf_item(g, "accessors", (size_t)index);
    const double vertices = gltf_number(a, "count", 0);
    if (!check_attributes(g, attributes, vertices,
                          arena_printf(g->arena, "%s/attributes", at)))
        return false;
    if (count_of(attributes, "JOINTS_") != count_of(attributes, "WEIGHTS_"))
        return gltf_fail(g, at, "has unequal numbers of JOINTS and WEIGHTS");
    return check_targets(g, primitive, vertices, at) && check_indices(g, primitive, at) &&
           check_material(g, primitive, at) && check_variants(g, primitive, at);
}

bool gltf_check_meshes(struct gltf *g) {
    for EACH (g, "meshes", i) {
        const struct json *mesh = gltf_item(g, "meshes", i);
        const struct json *primitives = json_get(mesh, "primitives");
        const struct json *weights = json_get(mesh, "weights");
        for (size_t k = 0; k < json_count(primitives); k++) {
            const char *at = arena_printf(g->arena, "/meshes/%zu/primitives/%zu", i, k);
            if (!check_primitive(g, json_at(primitives, k), at))
                return false;
        }
        const size_t targets = json_count(json_get(json_at(primitives, 0), "targets"));
        if (weights && json_count(weights) != targets)
            return gltf_fail(g, arena_printf(g->arena, "/meshes/%zu/weights", i),
                             "has %zu weights for %zu morph targets", json_count(weights), targets);
    }
    return true;
}
