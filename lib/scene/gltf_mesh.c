// SPDX-License-Identifier: Apache-2.0
// Primitives of glTF meshes (specification, 3.7.2) as triangle meshes.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/gltf.h"

enum { TRIANGLES = 4, STRIP, FAN };

static const struct json *attribute(const struct gltf *g, const struct json *primitive,
                                    const char *name) {
    const int64_t i = gltf_index(json_get(primitive, "attributes"), name);
    return i < 0 ? NULL : gltf_item(g, "accessors", (size_t)i);
}

static void corners_of(int64_t mode, size_t t, size_t corner[3]) {
    const size_t first = mode == TRIANGLES ? 3 * t : mode == STRIP ? t : 0;
    corner[0] = first;
    corner[1] = mode == TRIANGLES ? first + 1 : mode == STRIP ? t + 1 + t % 2 : t + 1;
    corner[2] = mode == TRIANGLES ? first + 2 : mode == STRIP ? t + 2 - t % 2 : t + 2;
}

// Triangles of a list of `count` corners; indices may be NULL: 0, 1, 2, ...
static void make_triangles(struct mesh *m, int64_t mode, const uint32_t *indices, size_t count) {
    const size_t triangles = mode == TRIANGLES ? count / 3 : count < 3 ? 0 : count - 2;
    m->indices = mem_array(triangles, sizeof *m->indices);
    m->triangle_count = (uint32_t)triangles;
    for (size_t t = 0; t < triangles; t++) {
        size_t corner[3];
        corners_of(mode, t, corner);
        for (int k = 0; k < 3; k++)
            m->indices[t][k] = indices ? indices[corner[k]] : (uint32_t)corner[k];
    }
}

static bool all_finite(const float *v, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(v[i]))
            return false;
    return true;
}

// Unit normals; false: some have no direction.
static bool normalise(float (*n)[3], size_t count) {
    for (size_t i = 0; i < count; i++) {
        const double l = sqrt((double)n[i][0] * n[i][0] + (double)n[i][1] * n[i][1] +
                              (double)n[i][2] * n[i][2]);
        if (!(l > 0 && isfinite(l)))
            return false;
        for (int k = 0; k < 3; k++)
            n[i][k] = (float)(n[i][k] / l);
    }
    return true;
}

static void read_normals(struct gltf *g, const struct json *primitive, const char *at,
                         struct mesh *m) {
    const struct json *a = attribute(g, primitive, "NORMAL");
    if (!a) // flat, as the specification wants it
        return;
    m->normals = (float(*)[3])(void *)gltf_read_floats(g, a, 3);
    if (normalise(m->normals, m->vertex_count))
        return;
    gltf_warn(g, "%s: normals without direction: its triangles are flat", at);
    mem_free(m->normals);
    m->normals = NULL;
}

// Two numbers per vertex; NULL: there are none.
static float *read_uvs(struct gltf *g, const struct json *primitive, const char *at, int set,
                       const struct mesh *m) {
    const struct json *a = attribute(g, primitive, arena_printf(g->arena, "TEXCOORD_%d", set));
    if (!a)
        return NULL;
    float *uvs = gltf_read_floats(g, a, 2);
    if (all_finite(uvs, 2 * (size_t)m->vertex_count))
        return uvs;
    gltf_warn(g, "%s: TEXCOORD_%d is not finite and is dropped", at, set);
    mem_free(uvs);
    return NULL;
}

// TEXCOORD_n becomes the attribute vertex_uvn.
static void read_more_uvs(struct gltf *g, const struct json *primitive, const char *at,
                          uint64_t sets, struct mesh *m) {
    for (int set = 0; set < GLTF_MOST_UV_SETS; set++) {
        float *uvs = sets >> set & 1 ? read_uvs(g, primitive, at, set, m) : NULL;
        if (!uvs)
            continue;
        struct mesh_attribute *out = &m->attributes[m->attribute_count++];
        *out = (struct mesh_attribute){.channels = 2, .data = uvs};
        snprintf(out->name, sizeof out->name, "vertex_uv%d", set);
    }
}

// COLOR_0 becomes the attributes vertex_color, and vertex_alpha where it has four components, clamped as
// the format wants it.
static void read_colours(struct gltf *g, const struct json *primitive, const char *at, struct mesh *m) {
    const struct json *a = attribute(g, primitive, "COLOR_0");
    if (!a)
        return;
    const bool alpha = strcmp(json_text(json_get(a, "type")), "VEC4") == 0;
    float *all = gltf_read_floats(g, a, 4);
    if (!all_finite(all, 4 * (size_t)m->vertex_count))
        gltf_warn(g, "%s: COLOR_0 has values that are not finite; they count as zero", at);
    for (uint32_t k = 0; k < (alpha ? 2 : 1); k++) {
        struct mesh_attribute *out = &m->attributes[m->attribute_count++];
        out->channels = k ? 1 : 3;
        snprintf(out->name, sizeof out->name, k ? "vertex_alpha" : "vertex_color");
        out->data = mem_array((size_t)m->vertex_count * (size_t)out->channels, sizeof(float));
        for (size_t i = 0; i < m->vertex_count; i++)
            for (int c = 0; c < out->channels; c++) {
                const float v = all[4 * i + (k ? 3 : (size_t)c)];
                out->data[i * (size_t)out->channels + (size_t)c] = clampf(isfinite(v) ? v : 0, 0, 1);
            }
    }
    mem_free(all);
}

static void warn_of_poses(struct gltf *g, const struct json *primitive) {
    if (json_get(primitive, "targets"))
        gltf_warn(g, "morph targets are not applied: meshes stand in their first shape");
}

bool gltf_read_primitive(struct gltf *g, const struct json *primitive, const char *at,
                         const struct gltf_mesh_wants *wants, struct mesh *m, bool *failed) {
    const int64_t mode = (int64_t)gltf_number(primitive, "mode", TRIANGLES);
    const struct json *position = attribute(g, primitive, "POSITION");
    const int64_t index = gltf_index(primitive, "indices");
    const struct json *indices = index < 0 ? NULL : gltf_item(g, "accessors", (size_t)index);
    *m = (struct mesh){0};
    if (mode < TRIANGLES) {
        gltf_warn(g, "points and lines are skipped");
        return false;
    }
    if (!position || gltf_extension(primitive, "KHR_draco_mesh_compression")) {
        gltf_warn(g, "%s: has no positions that can be read and is skipped", at);
        return false;
    }
    const size_t vertices = gltf_count(position), corners = indices ? gltf_count(indices) : vertices;
    m->vertex_count = (uint32_t)vertices;
    m->positions = (float(*)[3])(void *)gltf_read_floats(g, position, 3);
    *failed = !all_finite(m->positions[0], 3 * vertices) &&
              !gltf_fail(g, at, "positions hold NaN or infinity");
    uint32_t *list = indices ? gltf_read_indices(g, indices) : NULL;
    make_triangles(m, mode, list, corners);
    mem_free(list);
    read_normals(g, primitive, at, m);
    m->uvs = (float(*)[2])(void *)read_uvs(g, primitive, at, wants->uv_set, m);
    const int more = __builtin_popcountll(wants->more_uvs);
    if (more || attribute(g, primitive, "COLOR_0"))
        m->attributes = mem_array(2 + (size_t)more, sizeof *m->attributes);
    read_colours(g, primitive, at, m);
    read_more_uvs(g, primitive, at, wants->more_uvs, m);
    warn_of_poses(g, primitive);
    if (!*failed && m->triangle_count > 0)
        return true;
    if (!*failed)
        gltf_warn(g, "%s: holds no triangles and is skipped", at);
    mesh_finish(m);
    return false;
}
