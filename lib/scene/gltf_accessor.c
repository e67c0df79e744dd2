// SPDX-License-Identifier: Apache-2.0
// Accessors (specification, 3.6.2): typed views of buffers, as numbers. They have been checked to
// lie in their buffers.
#include <string.h>

#include "scene/gltf.h"

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT };

int gltf_component_size(int64_t type) {
    switch (type) {
    case BYTE:
    case UNSIGNED_BYTE: return 1;
    case SHORT:
    case UNSIGNED_SHORT: return 2;
    case UNSIGNED_INT:
    case FLOAT: return 4;
    default: return 0;
    }
}

int gltf_component_count(const char *type) {
    static const struct {
        const char *name;
        int count;
    } types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                 {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    for (size_t i = 0; type && i < sizeof types / sizeof *types; i++)
        if (strcmp(type, types[i].name) == 0)
            return types[i].count;
    return 0;
}

size_t gltf_element_size(const struct json *accessor) {
    const int size = gltf_component_size(gltf_index(accessor, "componentType"));
    const char *type = json_text(json_get(accessor, "type"));
    const int count = gltf_component_count(type);
    if (type && strncmp(type, "MAT", 3) == 0 && size < 4) { // columns begin at multiples of 4
        const int columns = type[3] - '0';
        return (size_t)(columns * ((columns * size + 3) / 4 * 4));
    }
    return (size_t)(size * count);
}

size_t gltf_count(const struct json *accessor) {
    return (size_t)gltf_number(accessor, "count", 0);
}

static float component(const unsigned char *p, int64_t type, bool normalised) {
    int16_t s;
    uint16_t us;
    uint32_t u;
    float f;
    switch (type) {
    case BYTE: f = (float)(int8_t)*p; return normalised ? maxf(f / 127, -1) : f;
    case UNSIGNED_BYTE: return normalised ? (float)*p / 255 : (float)*p;
    case SHORT:
        memcpy(&s, p, 2);
        return normalised ? maxf((float)s / 32767, -1) : (float)s;
    case UNSIGNED_SHORT: memcpy(&us, p, 2); return normalised ? (float)us / 65535 : (float)us;
    case UNSIGNED_INT: memcpy(&u, p, 4); return (float)u;
    default: memcpy(&f, p, 4); return f;
    }
}

static uint32_t whole(const unsigned char *p, int64_t type) {
    uint16_t us;
    uint32_t u;
    switch (type) {
    case UNSIGNED_BYTE: return *p;
    case UNSIGNED_SHORT: memcpy(&us, p, 2); return us;
    default: memcpy(&u, p, 4); return u;
    }
}

// The first byte of a view plus an offset; NULL where its buffer has no data.
static const unsigned char *bytes_of(const struct gltf *g, const struct json *where,
                                     size_t *stride, size_t element) {
    const struct json *view = gltf_item(g, "bufferViews", (size_t)gltf_index(where, "bufferView"));
    const unsigned char *data = g->buffers[gltf_index(view, "buffer")].data;
    *stride = (size_t)gltf_number(view, "byteStride", (double)element);
    return data ? data + (size_t)gltf_number(view, "byteOffset", 0) +
                      (size_t)gltf_number(where, "byteOffset", 0)
                : NULL;
}

static void put(const struct json *accessor, const unsigned char *p, int width, float *out) {
    const int64_t type = gltf_index(accessor, "componentType");
    const int size = gltf_component_size(type);
    const int count = gltf_component_count(json_text(json_get(accessor, "type")));
    const bool normalised = gltf_flag(accessor, "normalized");
    for (int c = 0; c < count && c < width; c++)
        out[c] = component(p + c * size, type, normalised);
}

static void put_sparse(const struct gltf *g, const struct json *accessor, int width, float *out) {
    const struct json *sparse = json_get(accessor, "sparse");
    const struct json *indices = json_get(sparse, "indices"), *values = json_get(sparse, "values");
    const int64_t type = gltf_index(indices, "componentType");
    const size_t size = (size_t)gltf_component_size(type), element = gltf_element_size(accessor);
    size_t stride;
    const unsigned char *i = bytes_of(g, indices, &stride, size);
    const unsigned char *v = bytes_of(g, values, &stride, element);
    for (size_t k = 0; i && v && k < gltf_count(sparse); k++)
        put(accessor, v + k * element, width, out + (size_t)width * whole(i + k * size, type));
}

float *gltf_read_floats(const struct gltf *g, const struct json *accessor, int width) {
    const size_t count = gltf_count(accessor);
    float *out = mem_array(count * (size_t)width + 3, sizeof *out); // padding as positions need
    size_t stride = 0;
    const unsigned char *p = gltf_index(accessor, "bufferView") >= 0
                                 ? bytes_of(g, accessor, &stride, gltf_element_size(accessor))
                                 : NULL;
    for (size_t i = 0; p && i < count; i++)
        put(accessor, p + i * stride, width, out + i * (size_t)width);
    if (json_get(accessor, "sparse"))
        put_sparse(g, accessor, width, out);
    return out;
}

uint32_t *gltf_read_indices(const struct gltf *g, const struct json *accessor) {
    const size_t count = gltf_count(accessor);
    const int64_t type = gltf_index(accessor, "componentType");
    uint32_t *out = mem_array(count, sizeof *out);
    size_t stride = 0;
    const unsigned char *p =
        gltf_index(accessor, "bufferView") >= 0
            ? bytes_of(g, accessor, &stride, (size_t)gltf_component_size(type))
            : NULL;
    for (size_t i = 0; p && i < count; i++)
        out[i] = whole(p + i * stride, type);
    const struct json *sparse = json_get(accessor, "sparse");
    if (!sparse)
        return out;
    const struct json *indices = json_get(sparse, "indices");
    const int64_t index_type = gltf_index(indices, "componentType");
    size_t unused;
    const unsigned char *at = bytes_of(g, indices, &unused, 0);
    const unsigned char *v = bytes_of(g, json_get(sparse, "values"), &unused, 0);
    for (size_t k = 0; at && v && k < gltf_count(sparse); k++)
        out[whole(at + k * (size_t)gltf_component_size(index_type), index_type)] =
            whole(v + k * (size_t)gltf_component_size(type), type);
    return out;
}
