// SPDX-License-Identifier: Apache-2.0
// The nodes of a glTF scene (specification, 3.5): meshes, instances, cameras and punctual lights.
//
// A mesh that one node uses becomes shapes in the world; one that several use becomes a shapegroup
// with instances, but for primitives that emit, which every node gets for itself.
#include <math.h>
#include <string.h>

#include "scene/formats.h"
#include "scene/gltf.h"

struct building {
    struct gltf *g;
    struct reader *r;
    struct xml_node *scene;
    uint32_t *uses;        // of each mesh, by nodes of the scene
    const char **groups;   // id of the shapegroup of each mesh, or NULL
    double lo[3], hi[3];   // of everything placed
    bool has_camera, has_light, has_shape, has_medium;
};

typedef bool (*visit_fn)(struct building *b, size_t node, const struct transform *to_world);

// ---- transforms -----------------------------------------------------------------------------

static struct transform local_transform(const struct json *node) {
    struct transform t = transform_identity;
    double m[16], move[3] = {0, 0, 0}, turn[4] = {0, 0, 0, 1}, size[3] = {1, 1, 1};
    if (gltf_numbers(node, "matrix", 16, m)) { // by columns
        for (int i = 0; i < 16; i++)
            t.m[i % 4][i / 4] = m[i];
        return t;
    }
    gltf_numbers(node, "translation", 3, move);
    gltf_numbers(node, "rotation", 4, turn);
    gltf_numbers(node, "scale", 3, size);
    const double x = turn[0], y = turn[1], z = turn[2], w = turn[3];
    const double norm = x * x + y * y + z * z + w * w, s = norm > 0 ? 2 / norm : 0;
    const double r[3][3] = {
        {1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
        {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)},
        {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            t.m[i][j] = r[i][j] * size[j];
        t.m[i][3] = move[i];
    }
    return t;
}

// Column k of the rotation part, unit; false: it has no direction.
static bool axis(const struct transform *t, int k, double out[3]) {
    double l = 0;
    for (int i = 0; i < 3; i++)
        l += t->m[i][k] * t->m[i][k];
    l = sqrt(l);
    for (int i = 0; i < 3; i++)
        out[i] = l > 0 ? t->m[i][k] / l : 0;
    return l > 0;
}

// ---- shapes ---------------------------------------------------------------------------------

static int colour_channels(const struct gltf *g, const struct json *primitive) {
    const int64_t i = gltf_index(json_get(primitive, "attributes"), "COLOR_0");
    if (i < 0)
        return 0;
    return gltf_component_count(json_text(json_get(gltf_item(g, "accessors", (size_t)i), "type")));
}

static bool add_emitter(struct building *b, struct xml_node *shape,
                        const struct gltf_material *m) {
    struct xml_node *light = tree_add(b->r, shape, "emitter", "area", NULL);
    for (int k = 0; k < 3; k++) // what glows no brighter than white is no lamp
        b->has_light |= m->emission[k] > 1;
    if (!m->emission_texture) {
        tree_triple(b->r, light, "rgb", "radiance", m->emission);
        return true;
    }
    struct xml_node *product = tree_add(b->r, light, "texture", "product", NULL);
    xml_set(product, "name", "radiance", b->r->arena);
    tree_triple(b->r, product, "rgb", "texture_1", m->emission);
    const struct gltf_texture_use use = {"texture_0", NULL, false, m->wants.uv_set};
    return gltf_add_texture(b->g, b->r, product, m->emission_texture, &use);
}

static void add_interior(struct building *b, struct xml_node *shape, const char *material,
                         const struct gltf_material *m) {
    if (!m->interior)
        return;
    b->has_medium = true;
    const char *id = arena_printf(b->r->arena, "inside of %s", material);
    if (id_find(b->r, id)) {
        struct xml_node *ref = tree_add(b->r, shape, "ref", NULL, id);
        xml_set(ref, "name", "interior", b->r->arena);
        return;
    }
    xml_set(m->interior, "id", id, b->r->arena);
    xml_append(shape, m->interior);
    id_define(b->r, id, m->interior, m->interior->at);
}

static void widen(struct building *b, const struct mesh *m, const struct transform *t) {
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        const double p[3] = {m->positions[i][0], m->positions[i][1], m->positions[i][2]};
        double q[3];
        transform_point(t, p, q);
        for (int k = 0; k < 3; k++) {
            b->lo[k] = fmin(b->lo[k], q[k]);
            b->hi[k] = fmax(b->hi[k], q[k]);
        }
    }
}

// One primitive as a shape in parent. emitting: only those that emit, or only those that do not.
static bool add_primitive(struct building *b, struct xml_node *parent, size_t mesh, size_t index,
                          const struct transform *to_world, bool emitting, const char *name) {
    struct gltf *g = b->g;
    const struct json *primitive =
        json_at(json_get(gltf_item(g, "meshes", mesh), "primitives"), index);
    struct gltf_material material;
    if (!gltf_make_material(g, b->r, b->scene, gltf_index(primitive, "material"),
                            colour_channels(g, primitive), &material))
        return false;
    if (material.emits != emitting)
        return true;
    const char *at = arena_printf(g->arena, "/meshes/%zu/primitives/%zu", mesh, index);
    struct mesh m;
    bool failed = false;
    if (!gltf_read_primitive(g, primitive, at, &material.wants, &m, &failed))
        return !failed;
    if (to_world)
        widen(b, &m, to_world);
    const char *wanted = name ? name : json_text(json_get(gltf_item(g, "meshes", mesh), "name"));
    const char *id = tree_free_id(b->r, wanted, arena_printf(g->arena, "meshes.%zu", mesh));
    struct xml_node *shape = tree_add_named(b->r, parent, "shape", "made", id);
    tree_integer(b->r, shape, "shape_index", tree_keep_mesh(b->r, &m));
    if (to_world && !transform_is_identity(to_world))
        tree_transform(b->r, shape, "to_world", to_world);
    tree_ref(b->r, shape, material.id);
    add_interior(b, shape, material.id, &material);
    b->has_shape = true;
    return !emitting || add_emitter(b, shape, &material);
}

static bool add_primitives(struct building *b, struct xml_node *parent, size_t mesh,
                           const struct transform *to_world, bool emitting, const char *name) {
    const size_t n = json_count(json_get(gltf_item(b->g, "meshes", mesh), "primitives"));
    for (size_t i = 0; i < n; i++)
        if (!add_primitive(b, parent, mesh, i, to_world, emitting, name))
            return false;
    return true;
}

// Bounds of an instance, from the meshes of its group.
static void widen_by_group(struct building *b, const struct xml_node *group,
                           const struct transform *to_world) {
    for (const struct xml_node *shape = group->first; shape; shape = shape->next)
        for (const struct xml_node *c = shape->first; c; c = c->next) {
            double index;
            const char *name = xml_get(c, "name");
            if (name && strcmp(name, "shape_index") == 0 &&
                value_numbers(xml_get(c, "value"), &index, 1) == 1)
                widen(b, &LIST_AT(&b->r->made, struct mesh, (size_t)index), to_world);
        }
}

static bool add_instance(struct building *b, size_t mesh, const struct transform *to_world,
                         const char *name) {
    if (!b->groups[mesh]) {
        const char *id = tree_free_id(b->r, NULL, arena_printf(b->g->arena, "group.%zu", mesh));
        struct xml_node *group = tree_add_named(b->r, b->scene, "shape", "shapegroup", id);
        b->groups[mesh] = id;
        if (!add_primitives(b, group, mesh, NULL, false, NULL))
            return false;
    }
    const struct xml_node *group = id_find(b->r, b->groups[mesh])->node;
    if (!group->first)
        return true;
    const char *id = tree_free_id(b->r, name, "instance");
    struct xml_node *instance = tree_add_named(b->r, b->scene, "shape", "instance", id);
    tree_ref(b->r, instance, b->groups[mesh]);
    tree_transform(b->r, instance, "to_world", to_world);
    widen_by_group(b, group, to_world);
    return true;
}

// ---- lights and cameras ---------------------------------------------------------------------

static void place(struct reader *r, struct xml_node *node, const struct transform *t,
                  const double scale[2]) {
    double right[3], up[3], back[3];
    struct transform m = transform_identity;
    axis(t, 0, right);
    axis(t, 1, up);
    axis(t, 2, back);
    for (int k = 0; k < 3; k++) { // ours looks along +z with x to the left
        m.m[k][0] = -right[k] * scale[0];
        m.m[k][1] = up[k] * scale[1];
        m.m[k][2] = -back[k];
        m.m[k][3] = t->m[k][3];
    }
    tree_transform(r, node, "to_world", &m);
}

static void add_spot(struct building *b, struct xml_node *node, const struct json *light,
                     const struct transform *t) {
    static const double one[2] = {1, 1};
    const double degrees = 180 / 3.14159265358979323846;
    const struct json *spot = json_get(light, "spot");
    const double outer = gltf_number(spot, "outerConeAngle", 0.785398163397448) * degrees;
    tree_number(b->r, node, "cutoff_angle", fmax(outer, 1e-3));
    tree_number(b->r, node, "beam_width",
                fmin(gltf_number(spot, "innerConeAngle", 0) * degrees, fmax(outer, 1e-3)));
    place(b->r, node, t, one);
}

static bool add_light(struct building *b, const struct json *extension, const struct transform *t) {
    const struct json *lights = json_get(gltf_extension(b->g->root, "KHR_lights_punctual"), "lights");
    const struct json *light = json_at(lights, (size_t)gltf_index(extension, "light"));
    const char *type = json_text(json_get(light, "type"));
    const bool far = strcmp(type, "directional") == 0, spot = strcmp(type, "spot") == 0;
    double colour[3] = {1, 1, 1}, back[3];
    if (!far && !spot && strcmp(type, "point") != 0) {
        gltf_warn(b->g, "a light of the unknown type \"%.40s\" is skipped", type);
        return true;
    }
    gltf_numbers(light, "color", 3, colour);
    for (int k = 0; k < 3; k++)
        colour[k] *= gltf_number(light, "intensity", 1);
    if (json_get(light, "range"))
        gltf_warn(b->g, "the range of lights is not used: they reach everywhere");
    const char *id = tree_free_id(b->r, json_text(json_get(light, "name")), type);
    struct xml_node *node = tree_add_named(b->r, b->scene, "emitter", type, id);
    tree_triple(b->r, node, "rgb", far ? "irradiance" : "intensity", colour);
    axis(t, 2, back);
    const double forward[3] = {-back[0], -back[1], -back[2]};
    const double position[3] = {t->m[0][3], t->m[1][3], t->m[2][3]};
    if (spot)
        add_spot(b, node, light, t);
    else
        tree_triple(b->r, node, far ? "vector" : "point", far ? "direction" : "position",
                    far ? forward : position);
    b->has_light = true;
    return true;
}

static bool add_camera(struct building *b, const struct json *camera, const struct transform *t) {
    struct reader *r = b->r;
    const bool flat = strcmp(json_text(json_get(camera, "type")), "orthographic") == 0;
    const struct json *lens = json_get(camera, flat ? "orthographic" : "perspective");
    double scale[2] = {1, 1};
    if (!lens)
        return true; // of a type that is not known: the schema has warned
    struct xml_node *node = tree_add(r, b->scene, "sensor", flat ? "orthographic" : "perspective",
                                     tree_free_id(r, json_text(json_get(camera, "name")), "camera"));
    if (flat)
        scale[0] = scale[1] = fmax(fabs(gltf_number(lens, "xmag", 1)), 1e-30);
    place(r, node, t, scale);
    if (!flat) {
        tree_text(r, node, "string", "fov_axis", "y");
        tree_number(r, node, "fov",
                    fmin(gltf_number(lens, "yfov", 1) * 180 / 3.14159265358979323846, 179));
    }
    const double near_clip = fmax(gltf_number(lens, "znear", 0), 1e-6);
    tree_number(r, node, "near_clip", near_clip);
    tree_number(r, node, "far_clip", fmax(gltf_number(lens, "zfar", 1e30), near_clip * 1.001));
    tree_add_film(r, node);
    b->has_camera = true;
    return id_define(r, xml_get(node, "id"), node, node->at);
}

// ---- nodes ----------------------------------------------------------------------------------

static bool count_use(struct building *b, size_t node, const struct transform *to_world) {
    const int64_t mesh = gltf_index(gltf_item(b->g, "nodes", node), "mesh");
    (void)to_world;
    if (mesh >= 0)
        b->uses[mesh]++;
    return true;
}

static bool has_inverse(const struct transform *t) {
    struct transform inverse;
    return transform_is_finite(t) && transform_invert(t, &inverse);
}

static bool build_node(struct building *b, size_t index, const struct transform *to_world) {
    struct gltf *g = b->g;
    const struct json *node = gltf_item(g, "nodes", index);
    const char *name = json_text(json_get(node, "name"));
    const int64_t mesh = gltf_index(node, "mesh"), camera = gltf_index(node, "camera");
    const struct json *light = gltf_extension(node, "KHR_lights_punctual");
    if ((mesh >= 0 || camera >= 0 || light) && !has_inverse(to_world)) {
        gltf_warn(g, "/nodes/%zu: its transform has no inverse: it is skipped", index);
        return true;
    }
    if (json_get(node, "skin"))
        gltf_warn(g, "skins are not applied: meshes stand as they were modelled");
    if (camera >= 0 && !add_camera(b, gltf_item(g, "cameras", (size_t)camera), to_world))
        return false;
    if (light && !add_light(b, light, to_world))
        return false;
    if (mesh < 0)
        return true;
    const bool shared = b->uses[mesh] > 1;
    return (shared ? add_instance(b, (size_t)mesh, to_world, name)
                   : add_primitives(b, b->scene, (size_t)mesh, to_world, false, name)) &&
           add_primitives(b, b->scene, (size_t)mesh, to_world, true, name);
}

// A node and everything under it, with a stack of our own: chains may be long.
static bool visit_tree(struct building *b, size_t root, visit_fn visit) {
    struct list stack = {0};
    struct pending {
        size_t node;
        struct transform above;
    };
    *LIST_ADD(&stack, struct pending) = (struct pending){root, transform_identity};
    bool ok = true;
    while (ok && stack.count > 0) {
        const struct pending p = LIST_AT(&stack, struct pending, --stack.count);
        const struct json *node = gltf_item(b->g, "nodes", p.node);
        const struct transform local = local_transform(node);
        const struct transform to_world = transform_multiply(&p.above, &local);
        ok = visit(b, p.node, &to_world);
        const struct json *children = json_get(node, "children");
        for (size_t i = json_count(children); ok && i-- > 0;) {
            double child;
            json_read_number(json_at(children, i), &child);
            *LIST_ADD(&stack, struct pending) = (struct pending){(size_t)child, to_world};
        }
    }
    mem_free(stack.items);
    return ok;
}

static bool visit_scene(struct building *b, visit_fn visit) {
    const int64_t chosen = gltf_index(b->g->root, "scene");
    const struct json *scene = gltf_item(b->g, "scenes", chosen < 0 ? 0 : (size_t)chosen);
    const struct json *nodes = json_get(scene, "nodes");
    for (size_t i = 0; i < json_count(nodes); i++) {
        double node;
        json_read_number(json_at(nodes, i), &node);
        if (!visit_tree(b, (size_t)node, visit))
            return false;
    }
    return true;
}

static bool build(struct building *b) {
    struct gltf *g = b->g;
    if (json_count(json_get(g->root, "animations")))
        gltf_warn(g, "animations are not played: everything stands in its first pose");
    if (!visit_scene(b, count_use) || !visit_scene(b, build_node))
        return false;
    if (!b->has_shape)
        return gltf_fail(g, "", "shows no triangles, expected a scene with a mesh");
    if (!b->has_camera)
        tree_add_view(b->r, b->scene, b->lo, b->hi);
    if (!b->has_light)
        tree_add_sky(b->r, b->scene);
    if (b->has_medium)
        tree_add(b->r, b->scene, "integrator", "volpath", NULL);
    return true;
}

// The file and what it keeps beside itself; pictures are added where they are used.
static bool hash_files(struct gltf *g, struct reader *r, const char *path) {
    const struct json *buffers = json_get(g->root, "buffers");
    bool ok = load_hash_file(r, path);
    for (size_t i = 0; i < json_count(buffers) && ok; i++) {
        const char *uri = json_text(json_get(json_at(buffers, i), "uri"));
        if (uri && !gltf_is_data_uri(uri))
            ok = load_hash_file(r, gltf_uri_path(g, uri, "/buffers"));
    }
    return ok;
}

struct xml_node *gltf_scene_tree(struct reader *r, const char *path) {
    struct gltf g;
    struct xml_node *scene = tree_add(r, NULL, "scene", NULL, NULL);
    struct building b = {.g = &g, .r = r, .scene = scene};
    for (int k = 0; k < 3; k++) {
        b.lo[k] = INFINITY;
        b.hi[k] = -INFINITY;
    }
    *LIST_ADD(&r->directories, const char *) = "."; // pictures are named by whole paths
    bool ok = gltf_open(&g, path, r->arena) && hash_files(&g, r, path);
    const size_t meshes = ok ? json_count(json_get(g.root, "meshes")) : 0;
    b.uses = mem_array(meshes, sizeof *b.uses);
    b.groups = mem_array(meshes, sizeof *b.groups);
    ok = ok && build(&b);
    mem_free(b.uses);
    mem_free(b.groups);
    gltf_close(&g);
    return ok ? scene : NULL;
}
