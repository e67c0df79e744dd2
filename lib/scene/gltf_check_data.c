// SPDX-License-Identifier: Apache-2.0
// Numbers in buffers: what can be checked only once they are loaded.
#include <math.h>
#include <string.h>

#include "scene/gltf_check.h"

static bool check_sparse_indices(struct gltf *g, const struct json *a, const char *at) {
    const struct json *sparse = json_get(a, "sparse"), *indices = json_get(sparse, "indices");
    const struct json *view = gltf_find(g, "bufferViews", gltf_index(indices, "bufferView"));
    const unsigned char *p = view ? g->buffers[gltf_index(view, "buffer")].data : NULL;
    const size_t size = (size_t)gltf_component_size(gltf_index(indices, "componentType"));
    double last = -1;
    if (!p)
        return true;
    p += (size_t)gltf_number(view, "byteOffset", 0) + (size_t)gltf_number(indices, "byteOffset", 0);
    for (size_t i = 0; i < gltf_count(sparse); i++, p += size) {
        double v = 0;
        for (size_t k = size; k-- > 0;)
            v = 256 * v + p[k];
        if (v <= last || v >= gltf_number(a, "count", 0))
            return gltf_fail(g, at, "replaces element %.0f, expected rising ones below %.0f", v,
                             gltf_number(a, "count", 0));
        last = v;
    }
    return true;
}

// Accessors without data, of their own or in their buffer, are for extensions to fill.
static bool has_data(const struct gltf *g, const struct json *accessor) {
    const struct json *view = gltf_find(g, "bufferViews", gltf_index(accessor, "bufferView"));
    return json_get(accessor, "sparse") || (view && g->buffers[gltf_index(view, "buffer")].data);
}

// min and max, where given, must be those of the data; to the rounding of JSON's decimals.
static bool check_bounds(struct gltf *g, const struct json *a, const char *at) {
    const struct json *min = json_get(a, "min"), *max = json_get(a, "max");
    const int n = gltf_component_count(json_text(json_get(a, "type")));
    if ((!min && !max) || gltf_flag(a, "normalized") || n > 4 || !has_data(g, a))
        return true;
    float *v = gltf_read_floats(g, a, n);
    bool ok = true;
    for (int c = 0; c < n && ok; c++) {
        double lo = INFINITY, hi = -INFINITY, told;
        for (size_t i = 0; i < gltf_count(a); i++) {
            lo = fmin(lo, v[i * (size_t)n + (size_t)c]);
            hi = fmax(hi, v[i * (size_t)n + (size_t)c]);
        }
        const double slack = 1e-5 * fmax(fabs(lo), fabs(hi));
        if (json_read_number(json_at(min, (size_t)c), &told) && fabs(told - lo) > slack)
            ok = gltf_fail(g, at, "has min %g, but its least value is %g", told, lo);
        else if (json_read_number(json_at(max, (size_t)c), &told) && fabs(told - hi) > slack)
            ok = gltf_fail(g, at, "has max %g, but its greatest value is %g", told, hi);
    }
    mem_free(v);
    return ok;
}

static bool check_indices(struct gltf *g, const struct json *primitive, const char *at) {
    const struct json *a = gltf_find(g, "accessors", gltf_index(primitive, "indices"));
    const struct json *attributes = json_get(primitive, "attributes");
    if (!a || !has_data(g, a))
        return true;
    const int size = gltf_component_size(gltf_index(a, "componentType"));
    const uint32_t restart = UINT32_MAX >> (32 - 8 * size);
    const struct json *first = gltf_find(g, "accessors", gltf_index(attributes, json_key(attributes, 0)));
    const size_t vertices = gltf_count(first);
    uint32_t *indices = gltf_read_indices(g, a);
    bool ok = true;
    for (size_t i = 0; i < gltf_count(a) && ok; i++)
        if (indices[i] >= vertices || indices[i] == restart)
            ok = gltf_fail(g, at, "has the index %u, but there are %zu vertices", indices[i],
                           vertices);
    mem_free(indices);
    return ok;
}

static bool check_times(struct gltf *g, const struct json *sampler, const char *at) {
    const struct json *a = gltf_find(g, "accessors", gltf_index(sampler, "input"));
    if (!has_data(g, a))
        return true;
    float *t = gltf_read_floats(g, a, 1);
    bool ok = t[0] >= 0 || gltf_fail(g, at, "has a time before 0");
    for (size_t i = 1; i < gltf_count(a) && ok; i++)
        ok = t[i] > t[i - 1] || gltf_fail(g, at, "has times that do not rise");
    mem_free(t);
    return ok;
}

// Rotations are unit quaternions; of splines the middle of three.
static bool check_rotations(struct gltf *g, const struct json *sampler, const char *at) {
    const struct json *a = gltf_find(g, "accessors", gltf_index(sampler, "output"));
    const char *kind = json_text(json_get(sampler, "interpolation"));
    const size_t step = kind && strcmp(kind, "CUBICSPLINE") == 0 ? 3 : 1;
    if (strcmp(json_text(json_get(a, "type")), "VEC4") != 0)
        return gltf_fail(g, at, "has rotations that are no VEC4");
    if (!has_data(g, a))
        return true;
    float *q = gltf_read_floats(g, a, 4);
    bool ok = true;
    for (size_t i = step / 3; i < gltf_count(a) && ok; i += step) {
        double l = 0;
        for (size_t c = 0; c < 4; c++)
            l += (double)q[4 * i + c] * q[4 * i + c];
        ok = fabs(sqrt(l) - 1) <= 0.01 || gltf_fail(g, at, "has a rotation of length %g", sqrt(l));
    }
    mem_free(q);
    return ok;
}

static bool check_animation(struct gltf *g, size_t i) {
    const struct json *animation = gltf_item(g, "animations", i);
    const struct json *samplers = json_get(animation, "samplers");
    const struct json *channels = json_get(animation, "channels");
    for (size_t k = 0; k < json_count(samplers); k++)
        if (!check_times(g, json_at(samplers, k),
                         arena_printf(g->arena, "/animations/%zu/samplers/%zu", i, k)))
            return false;
    for (size_t k = 0; k < json_count(channels); k++) {
        const struct json *channel = json_at(channels, k);
        const char *path = json_text(json_get(json_get(channel, "target"), "path"));
        const struct json *sampler = json_at(samplers, (size_t)gltf_index(channel, "sampler"));
        if (strcmp(path, "rotation") == 0 &&
            !check_rotations(g, sampler,
                             arena_printf(g->arena, "/animations/%zu/channels/%zu", i, k)))
            return false;
    }
    return true;
}

static bool check_image(struct gltf *g, size_t i) {
    const char *uri = json_text(json_get(gltf_item(g, "images", i), "uri"));
    const char *at = arena_printf(g->arena, "/images/%zu/uri", i);
    struct gltf_buffer unused;
    return !uri || (gltf_is_data_uri(uri) ? gltf_load_uri(g, uri, at, &unused)
                                          : gltf_uri_path(g, uri, at) != NULL);
}

bool gltf_check_data(struct gltf *g) {
    for EACH (g, "images", i)
        if (!check_image(g, i))
            return false;
    for EACH (g, "accessors", i) {
        const struct json *a = gltf_item(g, "accessors", i);
        const char *at = arena_printf(g->arena, "/accessors/%zu", i);
        if (!check_sparse_indices(g, a, at) || !check_bounds(g, a, at))
            return false;
    }
    for EACH (g, "meshes", i) {
        const struct json *primitives = json_get(gltf_item(g, "meshes", i), "primitives");
        for (size_t k = 0; k < json_count(primitives); k++)
            if (!check_indices(g, json_at(primitives, k),
                               arena_printf(g->arena, "/meshes/%zu/primitives/%zu", i, k)))
                return false;
    }
    for EACH (g, "animations", i)
        if (!check_animation(g, i))
            return false;
    return true;
}
