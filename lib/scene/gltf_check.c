// SPDX-License-Identifier: Apache-2.0
// Rules of the file as a whole, of pictures, cameras, lights and nodes.
#include "scene/gltf_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// ---- versions and extensions ----------------------------------------------------------------

static bool check_asset(struct gltf *g) {
    const struct json *asset = json_get(g->root, "asset");
    const char *version = json_text(json_get(asset, "version"));
    const char *least = json_text(json_get(asset, "minVersion"));
    int major = 0, minor = 0, least_major = 0, least_minor = 0;
    if (sscanf(version, "%d.%d", &major, &minor) != 2 || major != 2)
        return gltf_fail(g, "/asset/version", "is \"%.20s\", expected 2.0", version);
    if (!least)
        return true;
    if (sscanf(least, "%d.%d", &least_major, &least_minor) != 2 || least_major != 2 ||
        least_minor > minor || least_minor > 0)
        return gltf_fail(g, "/asset/minVersion", "is \"%.20s\", expected 2.0", least);
    return true;
}

static bool check_unique(struct gltf *g, const char *list) {
    const struct json *names = json_get(g->root, list);
    for (size_t i = 0; i < json_count(names); i++)
        for (size_t j = 0; j < i; j++)
            if (strcmp(json_text(json_at(names, i)), json_text(json_at(names, j))) == 0)
                return gltf_fail(g, arena_printf(g->arena, "/%s/%zu", list, i),
                                 "names an extension again");
    return true;
}

// What a model may require: what is read, and what changes nothing that is seen here.
static bool check_required(struct gltf *g) {
    static const char known[] =
        " KHR_texture_transform KHR_mesh_quantization KHR_lights_punctual EXT_texture_webp"
        " KHR_materials_anisotropy KHR_materials_clearcoat KHR_materials_dispersion"
        " KHR_materials_emissive_strength KHR_materials_ior KHR_materials_iridescence"
        " KHR_materials_sheen KHR_materials_specular KHR_materials_transmission"
        " KHR_materials_unlit KHR_materials_variants KHR_materials_volume KHR_animation_pointer"
        " KHR_node_visibility FB_ngon_encoding ";
    const struct json *names = json_get(g->root, "extensionsRequired");
    for (size_t i = 0; i < json_count(names); i++) {
        const char *name = json_text(json_at(names, i));
        if (!strstr(known, arena_printf(g->arena, " %s ", name)))
            return gltf_fail(g, arena_printf(g->arena, "/extensionsRequired/%zu", i),
                             "requires %.60s, which is not read here", name);
    }
    return true;
}

// ---- pictures, cameras, lights --------------------------------------------------------------

static bool check_image(struct gltf *g, size_t i) {
    const struct json *image = gltf_item(g, "images", i);
    const char *at = arena_printf(g->arena, "/images/%zu", i);
    const char *uri = json_text(json_get(image, "uri"));
    const struct json *view = gltf_find(g, "bufferViews", gltf_index(image, "bufferView"));
    if (!uri == !view)
        return gltf_fail(g, at, "has %s, expected exactly one of uri and bufferView",
                         uri ? "both" : "neither");
    if (json_get(view, "byteStride"))
        return gltf_fail(g, at, "lies in a buffer view with byteStride");
    if (uri && gltf_is_data_uri(uri) && strncmp(uri + 5, "image/png", 9) != 0 &&
        strncmp(uri + 5, "image/jpeg", 10) != 0 && strncmp(uri + 5, "image/webp", 10) != 0)
        return gltf_fail(g, at, "is of a type other than PNG and JPEG: %.30s", uri);
    return true;
}

static bool check_camera(struct gltf *g, size_t i) {
    const struct json *camera = gltf_item(g, "cameras", i);
    const char *at = arena_printf(g->arena, "/cameras/%zu", i);
    const char *type = json_text(json_get(camera, "type"));
    const struct json *flat = json_get(camera, "orthographic");
    const struct json *deep = json_get(camera, "perspective");
    const bool known = strcmp(type, "orthographic") == 0 || strcmp(type, "perspective") == 0;
    if (flat && deep)
        return gltf_fail(g, at, "has both orthographic and perspective, expected one");
    if (known && !json_get(camera, type))
        return gltf_fail(g, at, "lacks \"%s\"", type);
    if (!known)
        gltf_warn(g, "%s: is of the unknown type \"%.40s\"", at, type);
    if (flat && (gltf_number(flat, "xmag", 0) == 0 || gltf_number(flat, "ymag", 0) == 0))
        return gltf_fail(g, at, "has a magnification of zero");
    const struct json *lens = flat ? flat : deep;
    if (json_get(lens, "zfar") && gltf_number(lens, "zfar", 0) <= gltf_number(lens, "znear", 0))
        return gltf_fail(g, at, "has zfar %g, expected more than znear", gltf_number(lens, "zfar", 0));
    return true;
}

static bool check_spot(struct gltf *g, const struct json *light, const char *at) {
    const struct json *spot = json_get(light, "spot");
    if (!spot)
        return gltf_fail(g, at, "lacks \"spot\"");
    const double inner = gltf_number(spot, "innerConeAngle", 0);
    const double outer = gltf_number(spot, "outerConeAngle", 0.785398163397448);
    return inner < outer || gltf_fail(g, arena_printf(g->arena, "%s/spot", at),
                                      "has an inner cone of %g, not inside the outer one of %g", inner,
                                      outer);
}

static bool check_lights(struct gltf *g) {
    const struct json *lights = json_get(gltf_extension(g->root, "KHR_lights_punctual"), "lights");
    for (size_t i = 0; i < json_count(lights); i++) {
        const struct json *light = json_at(lights, i);
        if (strcmp(json_text(json_get(light, "type")), "spot") == 0 &&
            !check_spot(g, light,
                        arena_printf(g->arena, "/extensions/KHR_lights_punctual/lights/%zu", i)))
            return false;
    }
    return true;
}

static bool check_material(struct gltf *g, size_t i) {
    const struct json *ior =
        gltf_extension(gltf_item(g, "materials", i), "KHR_materials_ior");
    const double v = gltf_number(ior, "ior", 1.5);
    return (v == 0 || v >= 1) ||
           gltf_fail(g, arena_printf(g->arena, "/materials/%zu/extensions/KHR_materials_ior/ior", i),
                     "is %g, expected 0 or at least 1", v);
}

// ---- nodes ----------------------------------------------------------------------------------

// A scene names roots, each once.
static bool check_roots(struct gltf *g, size_t scene, const int64_t *parent) {
    const struct json *roots = json_get(gltf_item(g, "scenes", scene), "nodes");
    const size_t n = json_count(json_get(g->root, "nodes"));
    bool *seen = mem_array(n, sizeof *seen), ok = true;
    for (size_t i = 0; i < json_count(roots) && ok; i++) {
        const char *at = arena_printf(g->arena, "/scenes/%zu/nodes/%zu", scene, i);
        double node;
        json_read_number(json_at(roots, i), &node);
        ok = (!seen[(size_t)node] || gltf_fail(g, at, "is named for the second time")) &&
             (parent[(size_t)node] < 0 ||
              gltf_fail(g, at, "is a child of node %d, expected a root", (int)parent[(size_t)node]));
        seen[(size_t)node] = true;
    }
    mem_free(seen);
    return ok;
}

// Each node has at most one parent, so following parents ends at a root or shows a loop.
static bool check_tree(struct gltf *g) {
    const size_t n = json_count(json_get(g->root, "nodes"));
    int64_t *parent = mem_array(n, sizeof *parent);
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        parent[i] = -1;
    for (size_t i = 0; i < n && ok; i++) {
        const struct json *children = json_get(gltf_item(g, "nodes", i), "children");
        for (size_t k = 0; k < json_count(children) && ok; k++) {
            double child;
            json_read_number(json_at(children, k), &child);
            ok = parent[(size_t)child] < 0 ||
                 gltf_fail(g, arena_printf(g->arena, "/nodes/%zu/children/%zu", i, k),
                           "is a child for the second time");
            parent[(size_t)child] = (int64_t)i;
        }
    }
    for (size_t i = 0; i < n && ok; i++) {
        size_t steps = 0;
        for (int64_t p = parent[i]; p >= 0 && ok; p = parent[p])
            ok = ++steps <= n || gltf_fail(g, arena_printf(g->arena, "/nodes/%zu", i),
                                           "contains itself: a loop of nodes");
        if (steps > 4096 && ok)
            ok = gltf_fail(g, arena_printf(g->arena, "/nodes/%zu", i), "is nested too deep");
    }
    for (size_t i = 0; i < json_count(json_get(g->root, "scenes")) && ok; i++)
        ok = check_roots(g, i, parent);
    mem_free(parent);
    return ok;
}

// A matrix must be a translation, rotation and scale (glTF 2.0, 3.5.3), whose columns stand at right
// angles; written in float or fewer digits, they do so nearly.
static bool check_matrix(struct gltf *g, const char *at, const double m[16]) { // by columns
    static const double MOST_COSINE = 1e-3;
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        return gltf_fail(g, at, "has %g %g %g %g as its last row, expected 0 0 0 1", m[3], m[7],
                         m[11], m[15]);
    for (int i = 0; i < 3; i++) {
        const double *a = m + 4 * i, *b = m + 4 * ((i + 1) % 3);
        const double lengths = sqrt((a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) *
                                    (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]));
        if (fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) > MOST_COSINE * lengths)
            return gltf_fail(g, at, "is sheared: columns %d and %d are not at right angles", i,
                             (i + 1) % 3);
    }
    return true;
}

static bool check_node(struct gltf *g, size_t i) {
    const struct json *node = gltf_item(g, "nodes", i);
    const char *at = arena_printf(g->arena, "/nodes/%zu", i);
    const struct json *mesh = gltf_find(g, "meshes", gltf_index(node, "mesh"));
    const struct json *weights = json_get(node, "weights");
    const struct json *targets = json_get(json_at(json_get(mesh, "primitives"), 0), "targets");
    if (weights && mesh && json_count(weights) != json_count(targets))
        return gltf_fail(g, arena_printf(g->arena, "%s/weights", at),
                         "has %zu weights for %zu morph targets", json_count(weights),
                         json_count(targets));
    double m[16];
    return !gltf_numbers(node, "matrix", 16, m) ||
           check_matrix(g, arena_printf(g->arena, "%s/matrix", at), m);
}

static bool check_scenes(struct gltf *g) {
    for EACH (g, "nodes", i)
        if (!check_node(g, i))
            return false;
    return check_tree(g);
}

bool gltf_check_rules(struct gltf *g) {
    if (!check_asset(g) || !check_unique(g, "extensionsUsed") ||
        !check_unique(g, "extensionsRequired") || !check_required(g) || !check_lights(g))
        return false;
    for EACH (g, "images", i)
        if (!check_image(g, i))
            return false;
    for EACH (g, "cameras", i)
        if (!check_camera(g, i))
            return false;
    for EACH (g, "materials", i)
        if (!check_material(g, i))
            return false;
    return check_scenes(g) && gltf_check_views(g) && gltf_check_meshes(g) &&
           gltf_check_animations(g);
}
