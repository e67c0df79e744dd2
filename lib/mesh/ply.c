// SPDX-License-Identifier: Apache-2.0
// Stanford PLY, read as Mitsuba 3 reads it: element vertex with x y z, nx ny nz and u v (or
// texture_u texture_v, or s t), element face with the list vertex_index or vertex_indices, other
// properties as attributes (ply_attribute.h); integers among those are shares of their type's
// range, encoded as sRGB; v of texture coordinates is not flipped by default; vertex normals are
// computed when the file has none. Beyond Mitsuba: polygons (fans about their first corner), lists
// and elements that mean nothing here are stepped over, integer texture coordinates are shares of
// their type's range, positions and normals of any type are plain numbers.
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "base/text.h"
#include "math/colour.h"
#include "mesh/ply_attribute.h"
#include "mesh/ply_source.h"
#include "mesh/reader.h"

enum decode { DECODE_PLAIN, DECODE_SHARE, DECODE_SRGB };

// Where the values of one property go.
struct column {
    float *to; // NULL: nowhere
    int stride;
    enum decode decode;
};

struct ply {
    const char *path;
    const struct mesh_options *options;
    struct ply_header header;
    struct ply_source source;
    struct mesh *mesh;
    struct column columns[PLY_MOST_PROPERTIES];
    struct ply_attribute attributes[PLY_MOST_PROPERTIES]; // of the faces, as in mesh->attributes
    int attribute_count, first_attribute;
    size_t index_capacity, attribute_capacity[PLY_MOST_PROPERTIES];
    uint32_t *corners; // of one face
    size_t corner_capacity, small_faces;
    float row[PLY_MOST_PROPERTIES]; // of one face
};

static float decode_value(enum ply_type type, enum decode decode, double x) {
    static const double most[] = {
        [PLY_INT8] = 0x1p7 - 1,   [PLY_UINT8] = 0x1p8 - 1,   [PLY_INT16] = 0x1p15 - 1,
        [PLY_UINT16] = 0x1p16 - 1, [PLY_INT32] = 0x1p31 - 1, [PLY_UINT32] = 0x1p32 - 1,
        [PLY_INT64] = 0x1p63,     [PLY_UINT64] = 0x1p64};
    if (decode == DECODE_PLAIN || !ply_type_is_integer(type))
        return (float)x;
    const float share = (float)(x / most[type]);
    return decode == DECODE_SHARE ? share : colour_srgb_to_linear(share);
}

static bool read_float(struct ply *f, int property, enum decode decode, float *out) {
    const struct ply_property *q = &f->header.properties[property];
    double x;
    if (!ply_value(&f->source, q->type, &x))
        return false;
    *out = decode_value(q->type, decode, x);
    if (isfinite(*out))
        return true;
    log_error_at(f->source.at, "found %g in %s, expected a finite number of single precision", x,
                 q->name);
    return false;
}

static bool skip_property(struct ply *f, const struct ply_property *q) {
    uint32_t count = 1;
    if (q->count_type != PLY_NONE && !ply_list_count(&f->source, q, &count))
        return false;
    return ply_skip(&f->source, q->type, count);
}

// Assigns the properties named (n of them) to one array; false when one is missing.
static bool assign(struct ply *f, const struct ply_element *e, const char *const *names, int n,
                   enum decode decode, bool *used, struct column *out[3]) {
    int index[3];
    for (int k = 0; k < n; k++) {
        index[k] = ply_find_property(&f->header, e, names[k], false);
        if (index[k] < 0)
            return false;
    }
    for (int k = 0; k < n; k++) {
        used[index[k]] = true;
        out[k] = &f->columns[index[k]];
        *out[k] = (struct column){.stride = n, .decode = decode};
    }
    return true;
}

static void set_targets(struct column *const *columns, int n, float *data) {
    for (int k = 0; k < n; k++)
        columns[k]->to = data + k;
}

static void plan_attributes(struct ply *f, const struct ply_element *e, const char *prefix,
                            bool *used, size_t count) {
    struct ply_attribute *found = f->attributes;
    const int n = ply_group_attributes(f->path, &f->header, e, prefix, used, found);
    f->attribute_count = 0;
    f->first_attribute = (int)f->mesh->attribute_count;
    for (int i = 0; i < n; i++) {
        const struct mesh_attribute *a =
            mesh_add_attribute(f->mesh, f->path, found[i].name, found[i].channels, count);
        if (!a)
            continue;
        for (int k = 0; k < a->channels; k++)
            f->columns[found[i].property[k]] =
                (struct column){a->data + k, a->channels,
                                found[i].plain ? DECODE_PLAIN : DECODE_SRGB};
        f->attributes[f->attribute_count++] = found[i];
    }
}

static bool plan_vertices(struct ply *f, const struct ply_element *e) {
    static const char *const xyz[] = {"x", "y", "z"}, *const normal[] = {"nx", "ny", "nz"};
    static const char *const uv[3][2] = {{"u", "v"}, {"texture_u", "texture_v"}, {"s", "t"}};
    bool used[PLY_MOST_PROPERTIES] = {false};
    struct mesh *m = f->mesh;
    struct column *columns[3];
    if (!assign(f, e, xyz, 3, DECODE_PLAIN, used, columns)) {
        log_error("%s: element vertex has no properties x, y and z", f->path);
        return false;
    }
    m->positions = mesh_alloc_positions(e->count);
    set_targets(columns, 3, m->positions[0]);
    if (assign(f, e, normal, 3, DECODE_PLAIN, used, columns) && !f->options->face_normals) {
        m->normals = mem_array(e->count, sizeof *m->normals);
        set_targets(columns, 3, m->normals[0]);
    }
    bool found = false;
    for (int i = 0; i < 3 && !found; i++)
        found = assign(f, e, uv[i], 2, DECODE_SHARE, used, columns);
    if (found) {
        m->uvs = mem_array(e->count, sizeof *m->uvs);
        set_targets(columns, 2, m->uvs[0]);
    }
    plan_attributes(f, e, "vertex_", used, e->count);
    return true;
}

static bool read_vertices(struct ply *f, const struct ply_element *e) {
    if (!plan_vertices(f, e))
        return false;
    for (size_t i = 0; i < e->count; i++)
        for (int j = e->first; j < e->first + e->property_count; j++) {
            const struct column *c = &f->columns[j];
            if (!(c->to ? read_float(f, j, c->decode, c->to + i * (size_t)c->stride)
                        : skip_property(f, &f->header.properties[j])))
                return false;
        }
    return true;
}

// Makes room for `need` triangles.
static void grow_triangles(struct ply *f, size_t need) {
    struct mesh *m = f->mesh;
    mem_grow(&m->indices, &f->index_capacity, need, sizeof *m->indices);
    for (int i = 0; i < f->attribute_count; i++) {
        struct mesh_attribute *a = &m->attributes[f->first_attribute + i];
        mem_grow(&a->data, &f->attribute_capacity[i], need, (size_t)a->channels * sizeof(float));
    }
}

static bool read_corners(struct ply *f, const struct ply_property *q, uint32_t *count) {
    if (!ply_list_count(&f->source, q, count))
        return false;
    mem_grow(&f->corners, &f->corner_capacity, *count, sizeof *f->corners);
    for (uint32_t k = 0; k < *count; k++) {
        double x;
        if (!ply_value(&f->source, q->type, &x))
            return false;
        if (!(x >= 0 && x < f->mesh->vertex_count && x == floor(x))) {
            log_error_at(f->source.at, "found the index %g in %s, expected one of the %u vertices",
                         x, q->name, f->mesh->vertex_count);
            return false;
        }
        f->corners[k] = (uint32_t)x;
    }
    return true;
}

// The polygon in f->corners as triangles, each with the attributes in f->row.
static bool add_polygon(struct ply *f, uint32_t corners) {
    struct mesh *m = f->mesh;
    if (corners < 3) {
        f->small_faces++;
        return true;
    }
    if ((uint64_t)m->triangle_count + corners - 2 >= UINT32_MAX) {
        log_error("%s: holds more than 4294967294 triangles", f->path);
        return false;
    }
    grow_triangles(f, (size_t)m->triangle_count + corners - 2);
    for (uint32_t k = 2; k < corners; k++) {
        uint32_t *triangle = m->indices[m->triangle_count];
        triangle[0] = f->corners[0];
        triangle[1] = f->corners[k - 1];
        triangle[2] = f->corners[k];
        for (int i = 0; i < f->attribute_count; i++) {
            struct mesh_attribute *a = &m->attributes[f->first_attribute + i];
            float *to = a->data + (size_t)m->triangle_count * (size_t)a->channels;
            for (int c = 0; c < a->channels; c++)
                to[c] = f->row[f->attributes[i].property[c]];
        }
        m->triangle_count++;
    }
    return true;
}

static bool read_face(struct ply *f, const struct ply_element *e, int list) {
    uint32_t corners = 0;
    for (int j = e->first; j < e->first + e->property_count; j++) {
        const struct ply_property *q = &f->header.properties[j];
        if (!(j == list             ? read_corners(f, q, &corners)
              : f->columns[j].to    ? read_float(f, j, f->columns[j].decode, &f->row[j])
                                    : skip_property(f, q)))
            return false;
    }
    return add_polygon(f, corners);
}

static bool read_faces(struct ply *f, const struct ply_element *e) {
    bool used[PLY_MOST_PROPERTIES] = {false};
    int list = ply_find_property(&f->header, e, "vertex_indices", true);
    if (list < 0)
        list = ply_find_property(&f->header, e, "vertex_index", true);
    if (list < 0) {
        log_error("%s: element face has no list vertex_indices or vertex_index", f->path);
        return false;
    }
    // as many as if all were triangles, or fewer where the file is too short for that
    const struct ply_property *q = &f->header.properties[list];
    const size_t each = ply_least_bytes(&f->source, q->count_type, 1) +
                        ply_least_bytes(&f->source, q->type, 3);
    const size_t fit = (size_t)(f->source.end - f->source.p + 1) / each;
    const size_t room = e->count < fit ? e->count : fit;
    plan_attributes(f, e, "face_", used, room);
    for (int i = 0; i < f->attribute_count; i++)
        f->attribute_capacity[i] = room;
    f->mesh->indices = mem_array(room, sizeof *f->mesh->indices);
    f->index_capacity = room;
    for (uint32_t i = 0; i < e->count; i++)
        if (!read_face(f, e, list))
            return false;
    if (f->small_faces)
        log_warn("%s: %zu faces with fewer than 3 corners are skipped", f->path, f->small_faces);
    return true;
}

static bool skip_element(struct ply *f, const struct ply_element *e) {
    log_warn("%s: element %s is skipped", f->path, e->name);
    for (uint32_t i = 0; e->property_count && i < e->count; i++)
        for (int j = e->first; j < e->first + e->property_count; j++)
            if (!skip_property(f, &f->header.properties[j]))
                return false;
    return true;
}

static bool read_elements(struct ply *f) {
    const struct ply_header *h = &f->header;
    const struct ply_element *vertices = ply_find_element(h, "vertex");
    const struct ply_element *faces = ply_find_element(h, "face");
    if (!vertices || !faces) {
        log_error("%s: has no element %s%s", f->path, vertices ? "face" : "vertex",
                  ply_find_element(h, "tristrips") ? " (triangle strips are not read)" : "");
        return false;
    }
    f->mesh->vertex_count = vertices->count;
    for (const struct ply_element *e = h->elements; e < h->elements + h->element_count; e++)
        if (!ply_check_element(&f->source, h, e) ||
            !(e == vertices ? read_vertices(f, e)
              : e == faces  ? read_faces(f, e)
                            : skip_element(f, e)))
            return false;
    const char *p = f->source.p;
    while (f->source.format == PLY_ASCII && text_is_space(*p))
        p++;
    if (p < f->source.end)
        log_warn("%s: %td bytes after the last element are skipped", f->path, f->source.end - p);
    return true;
}

static bool read_ply(const char *path, const struct mesh_options *options, struct mesh *m) {
    *m = (struct mesh){0};
    size_t size;
    char *text = file_read(path, 0, &size);
    if (!text)
        return false;
    struct ply *f = mem_array(1, sizeof *f);
    f->path = path;
    f->options = options;
    f->mesh = m;
    bool good = ply_read_header(path, text, size, &f->header);
    if (good) {
        f->source = ply_source_open(path, text, size, &f->header);
        good = read_elements(f);
    }
    mem_free(text);
    mem_free(f->corners);
    mem_free(f);
    good = good && mesh_complete(m, path, options, options->flip_uvs);
    if (!good)
        mesh_finish(m);
    return good;
}

static const char *const extensions[] = {"ply", NULL};

const struct mesh_reader_type mesh_reader_ply = {
    .entry = {.name = "ply", .help = "Stanford PLY, text or binary, with attributes"},
    .extensions = extensions,
    .read = read_ply,
};
