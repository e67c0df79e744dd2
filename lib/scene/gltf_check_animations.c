// SPDX-License-Identifier: Apache-2.0
// Animations and skins, which are checked although they are not played: a damaged file is told.
#include <math.h>
#include <string.h>

#include "scene/gltf_check.h"

static bool check_sampler(struct gltf *g, const struct json *sampler, const char *at) {
    const struct json *input = gltf_find(g, "accessors", gltf_index(sampler, "input"));
    const struct json *output = gltf_find(g, "accessors", gltf_index(sampler, "output"));
    const char *kind = json_text(json_get(sampler, "interpolation"));
    const struct json *both[] = {input, output};
    for (int k = 0; k < 2; k++)
        if (json_get(gltf_find(g, "bufferViews", gltf_index(both[k], "bufferView")), "byteStride"))
            return gltf_fail(g, at, "lies in a buffer view with byteStride");
    if (!json_get(input, "min") || !json_get(input, "max"))
        return gltf_fail(g, at, "has times without min and max");
    if (kind && strcmp(kind, "CUBICSPLINE") == 0 && gltf_number(input, "count", 0) < 2)
        return gltf_fail(g, at, "is a spline through fewer than 2 times");
    return true;
}

static bool same_target(const struct json *a, const struct json *b) {
    return gltf_index(a, "node") >= 0 && gltf_index(a, "node") == gltf_index(b, "node") &&
           strcmp(json_text(json_get(a, "path")), json_text(json_get(b, "path"))) == 0;
}

static bool check_channel(struct gltf *g, const struct json *animation, size_t index,
                          const char *at) {
    const struct json *channels = json_get(animation, "channels");
    const struct json *channel = json_at(channels, index), *target = json_get(channel, "target");
    const char *path = json_text(json_get(target, "path"));
    const struct json *node = gltf_find(g, "nodes", gltf_index(target, "node"));
    if (gltf_number(channel, "sampler", 0) >= (double)json_count(json_get(animation, "samplers")))
        return gltf_fail(g, at, "names no sampler");
    if (json_get(node, "matrix") && strcmp(path, "weights") != 0)
        return gltf_fail(g, at, "moves a node that has a matrix");
    if (gltf_extension(target, "KHR_animation_pointer") && strcmp(path, "pointer") != 0)
        return gltf_fail(g, at, "has the path \"%.20s\", expected \"pointer\"", path);
    for (size_t k = 0; k < index; k++)
        if (same_target(json_get(json_at(channels, k), "target"), target))
            return gltf_fail(g, at, "has the target of channel %zu", k);
    return true;
}

static bool check_animation(struct gltf *g, size_t i) {
    const struct json *animation = gltf_item(g, "animations", i);
    const struct json *samplers = json_get(animation, "samplers");
    for (size_t k = 0; k < json_count(samplers); k++)
        if (!check_sampler(g, json_at(samplers, k),
                           arena_printf(g->arena, "/animations/%zu/samplers/%zu", i, k)))
            return false;
    for (size_t k = 0; k < json_count(json_get(animation, "channels")); k++)
        if (!check_channel(g, animation, k,
                           arena_printf(g->arena, "/animations/%zu/channels/%zu", i, k)))
            return false;
    return true;
}

// The topmost node above each; nodes are no loops.
static size_t root_of(const int64_t *parents, size_t node) {
    while (parents[node] >= 0)
        node = (size_t)parents[node];
    return node;
}

static bool check_skin(struct gltf *g, size_t i, const int64_t *parents) {
    const struct json *skin = gltf_item(g, "skins", i), *joints = json_get(skin, "joints");
    const char *at = arena_printf(g->arena, "/skins/%zu", i);
    const struct json *matrices = gltf_find(g, "accessors", gltf_index(skin, "inverseBindMatrices"));
    if (matrices && gltf_number(matrices, "count", 0) < (double)json_count(joints))
        return gltf_fail(g, at, "has fewer matrices than joints");
    size_t first = 0;
    for (size_t k = 0; k < json_count(joints); k++) {
        double joint;
        json_read_number(json_at(joints, k), &joint);
        const size_t root = root_of(parents, (size_t)joint);
        if (k > 0 && root != first)
            return gltf_fail(g, at, "has joints without a common root");
        first = root;
    }
    return true;
}

static bool check_skins(struct gltf *g) {
    const size_t n = json_count(json_get(g->root, "nodes"));
    int64_t *parents = mem_array(n, sizeof *parents);
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        parents[i] = -1;
    for (size_t i = 0; i < n; i++) {
        const struct json *children = json_get(gltf_item(g, "nodes", i), "children");
        for (size_t k = 0; k < json_count(children); k++) {
            double child;
            json_read_number(json_at(children, k), &child);
            parents[(size_t)child] = (int64_t)i;
        }
    }
    for EACH (g, "skins", i)
        ok = ok && check_skin(g, i, parents);
    mem_free(parents);
    return ok;
}

bool gltf_check_animations(struct gltf *g) {
    for EACH (g, "animations", i)
        if (!check_animation(g, i))
            return false;
    return check_skins(g);
}
