// SPDX-License-Identifier: Apache-2.0
// Buffer views and accessors: they must lie where they say, and hold what they say.
#include <math.h>
#include <string.h>

#include "scene/gltf_check.h"

// An accessor without data, all zero, may claim this many elements.
enum { MOST_ZEROS = 1 << 24 };

static bool check_view(struct gltf *g, size_t i) {
    const struct json *view = gltf_item(g, "bufferViews", i);
    const char *at = arena_printf(g->arena, "/bufferViews/%zu", i);
    const struct json *buffer = gltf_find(g, "buffers", gltf_index(view, "buffer"));
    const double end = gltf_number(view, "byteOffset", 0) + gltf_number(view, "byteLength", 0);
    if (end > gltf_number(buffer, "byteLength", 0))
        return gltf_fail(g, at, "ends at byte %.0f of a buffer of %.0f", end,
                         gltf_number(buffer, "byteLength", 0));
    if (fmod(gltf_number(view, "byteStride", 4), 4) != 0)
        return gltf_fail(g, at, "has the byteStride %g, no multiple of 4",
                         gltf_number(view, "byteStride", 4));
    return true;
}

// How elements lie in a view, in bytes.
struct layout {
    int element, last;          // with the padding of a matrix's last column, and without
    int component;              // the start in the buffer is a multiple of this ...
    int alignment;              // ... and the offset in the view of this
};

static struct layout layout_of(const struct json *accessor) {
    const char *type = json_text(json_get(accessor, "type"));
    const int size = gltf_component_size(gltf_index(accessor, "componentType"));
    const int element = (int)gltf_element_size(accessor);
    if (strncmp(type, "MAT", 3) != 0)
        return (struct layout){element, element, size, size};
    const int columns = type[3] - '0', padding = element / columns - columns * size;
    return (struct layout){element, element - padding, size, 4};
}

// Whether `count` elements lie in the view.
static bool check_range(struct gltf *g, const struct json *where, const char *at, double count,
                        struct layout l) {
    const struct json *view = gltf_find(g, "bufferViews", gltf_index(where, "bufferView"));
    const double stride = gltf_number(view, "byteStride", l.element);
    const double offset = gltf_number(where, "byteOffset", 0);
    const double start = offset + gltf_number(view, "byteOffset", 0);
    if (stride < l.element)
        return gltf_fail(g, at, "has elements of %d bytes, which overlap", l.element);
    if (offset + stride * (count - 1) + l.last > gltf_number(view, "byteLength", 0))
        return gltf_fail(g, at, "has %.0f elements of %d bytes and reaches beyond its buffer view",
                         count, l.element);
    if (fmod(offset, l.alignment) == 0 && fmod(start, l.component) == 0)
        return true;
    return gltf_fail(g, at, "begins at byte %.0f, no multiple of %d", start, l.alignment);
}

static bool check_sparse(struct gltf *g, const struct json *accessor, const char *at) {
    const struct json *sparse = json_get(accessor, "sparse");
    const struct json *indices = json_get(sparse, "indices"), *values = json_get(sparse, "values");
    const double count = gltf_number(sparse, "count", 0);
    const int64_t type = gltf_index(indices, "componentType");
    const int size = gltf_component_size(type);
    if (count > gltf_number(accessor, "count", 0))
        return gltf_fail(g, at, "replaces %.0f elements of %.0f", count,
                         gltf_number(accessor, "count", 0));
    if (type != 5121 && type != 5123 && type != 5125)
        return gltf_fail(g, at, "has indices of the component type %lld", (long long)type);
    const struct json *parts[] = {indices, values};
    for (int k = 0; k < 2; k++) {
        const struct json *view = gltf_find(g, "bufferViews", gltf_index(parts[k], "bufferView"));
        if (json_get(view, "byteStride"))
            return gltf_fail(g, at, "lies in a buffer view with byteStride");
    }
    return check_range(g, indices, at, count, (struct layout){size, size, size, size}) &&
           check_range(g, values, at, count, layout_of(accessor));
}

static bool check_accessor(struct gltf *g, size_t i) {
    const struct json *a = gltf_item(g, "accessors", i);
    const char *at = arena_printf(g->arena, "/accessors/%zu", i);
    const char *type = json_text(json_get(a, "type"));
    const int components = gltf_component_count(type);
    const int size = gltf_component_size(gltf_index(a, "componentType"));
    if (size == 0 || components == 0)
        return gltf_fail(g, at, "is of an unknown type (%.20s of %lld)", type,
                         (long long)gltf_index(a, "componentType"));
    for (int k = 0; k < 2; k++) {
        const struct json *bound = json_get(a, k ? "max" : "min");
        if (bound && json_count(bound) != (size_t)components)
            return gltf_fail(g, at, "has %zu bounds for %d components", json_count(bound),
                             components);
    }
    const double count = gltf_number(a, "count", 0);
    if (!json_get(a, "bufferView") && count > MOST_ZEROS)
        return gltf_fail(g, at, "claims %.0f elements without data", count);
    if (json_get(a, "bufferView") && !check_range(g, a, at, count, layout_of(a)))
        return false;
    return !json_get(a, "sparse") ||
           check_sparse(g, a, arena_printf(g->arena, "%s/sparse", at));
}

bool gltf_check_views(struct gltf *g) {
    for EACH (g, "bufferViews", i)
        if (!check_view(g, i))
            return false;
    for EACH (g, "accessors", i)
        if (!check_accessor(g, i))
            return false;
    return true;
}
