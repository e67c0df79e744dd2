// SPDX-License-Identifier: Apache-2.0
#include "driver/mesh_info.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/mesh.h"

struct row {
    uint64_t vertices, triangles;
    bool normals, uvs;
};

struct meshes {
    struct row all, *each;
    float low[3], high[3];
    struct json *attributes; // that any has
};

static void name_attributes(const struct mesh *m, struct json *names) {
    for (uint32_t i = 0; i < m->attribute_count; i++) {
        const char *name = m->attributes[i].name;
        size_t k = 0;
        while (k < json_count(names) && strcmp(json_text(json_at(names, k)), name) != 0)
            k++;
        if (k == json_count(names))
            json_append_text(names, name);
    }
}

static void take(struct meshes *to, int i, const struct mesh *m) {
    const struct row row = {m->vertex_count, m->triangle_count, m->normals != NULL, m->uvs != NULL};
    to->each[i] = row;
    to->all.vertices += row.vertices;
    to->all.triangles += row.triangles;
    to->all.normals = (i == 0 || to->all.normals) && row.normals;
    to->all.uvs = (i == 0 || to->all.uvs) && row.uvs;
    name_attributes(m, to->attributes);
    for (uint32_t v = 0; v < m->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++) {
            const float x = m->positions[v][axis];
            const bool first = i == 0 && v == 0;
            to->low[axis] = first ? x : fminf(to->low[axis], x);
            to->high[axis] = first ? x : fmaxf(to->high[axis], x);
        }
}

static void add_row(const struct row *row, struct json *out) {
    json_add_count(out, "vertices", (int64_t)row->vertices);
    json_add_count(out, "triangles", (int64_t)row->triangles);
    json_add_bool(out, "normals", row->normals);
    json_add_bool(out, "uvs", row->uvs);
}

static void add(const struct meshes *meshes, int count, bool tell_each, struct json *out) {
    json_add_text(out, "kind", "mesh");
    json_add_count(out, "meshes", count);
    add_row(&meshes->all, out);
    struct json *names = json_add_array(out, "attributes");
    for (size_t i = 0; i < json_count(meshes->attributes); i++)
        json_append_text(names, json_text(json_at(meshes->attributes, i)));
    struct json *min = json_add_array(out, "min"), *max = json_add_array(out, "max");
    for (int axis = 0; axis < 3; axis++) {
        json_append_number(min, (double)meshes->low[axis]);
        json_append_number(max, (double)meshes->high[axis]);
    }
    struct json *each = tell_each ? json_add_array(out, "each") : NULL;
    for (int i = 0; tell_each && i < count; i++)
        add_row(&meshes->each[i], json_append_object(each));
}

bool mesh_info_add(const char *path, int most_rows, struct json *out) {
    const struct mesh_reader_type *reader = mesh_reader_for(path);
    int count = 1;
    if (!reader || (reader->count && !reader->count(path, &count)))
        return false;
    struct meshes meshes = {.each = mem_array((size_t)count, sizeof *meshes.each),
                            .attributes = json_new_array()};
    bool good = true;
    for (int i = 0; i < count && good; i++) {
        const struct mesh_options options = {.shape_index = i};
        struct mesh m = {0};
        good = reader->read(path, &options, &m);
        if (good)
            take(&meshes, i, &m);
        mesh_finish(&m);
    }
    if (good)
        add(&meshes, count, count > 1 && count <= most_rows, out);
    json_destroy(meshes.attributes);
    mem_free(meshes.each);
    return good;
}
