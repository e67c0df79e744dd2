// SPDX-License-Identifier: Apache-2.0
// An OBJ file with its MTL files as a scene: one shape for each material it uses.
#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "scene/formats.h"
#include "scene/obj_materials.h"

struct obj_scene {
    struct reader *r;
    struct xml_node *scene;
    const char *path;
    struct list materials; // struct mtl
    struct list used;      // const char *: names behind usemtl, "" before the first
    double lo[3], hi[3];
    bool has_light;
};

static void add_library(struct obj_scene *o, const char *name) {
    char directory[PATH_MAX];
    file_directory(o->path, directory, sizeof directory);
    const char *path =
        name[0] == '/' ? name : arena_printf(o->r->arena, "%s/%s", directory, name);
    if (!file_exists(path))
        log_warn("%s: there is no material file \"%s\": its materials are plain", o->path, name);
    else
        mtl_read(o->r, path, &o->materials);
}

static void add_used(struct obj_scene *o, const char *name) {
    for (size_t i = 0; i < o->used.count; i++)
        if (strcmp(LIST_AT(&o->used, const char *, i), name) == 0)
            return;
    *LIST_ADD(&o->used, const char *) = name;
}

// The rest of a line behind a word that it begins with, or NULL.
static const char *rest_behind(struct reader *r, const char *line, const char *end,
                               const char *word) {
    const size_t n = strlen(word);
    while (line < end && (*line == ' ' || *line == '\t'))
        line++;
    if ((size_t)(end - line) <= n || strncmp(line, word, n) != 0 ||
        !(line[n] == ' ' || line[n] == '\t'))
        return NULL;
    line += n;
    while (line < end && (*line == ' ' || *line == '\t'))
        line++;
    while (end > line && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    return arena_printf(r->arena, "%.*s", (int)(end - line), line);
}

// Looks for mtllib and usemtl; the mesh reader checks everything else.
static bool scan(struct obj_scene *o) {
    size_t size;
    char *text = file_read(o->path, 0, &size);
    if (!text)
        return false;
    const char *material = "";
    for (const char *p = text; p < text + size;) {
        const char *end = p + strcspn(p, "\r\n");
        const char *library = rest_behind(o->r, p, end, "mtllib");
        const char *named = rest_behind(o->r, p, end, "usemtl");
        const size_t blank = strspn(p, " \t");
        if (library)
            add_library(o, library);
        material = named ? named : material;
        if (p[blank] == 'f' && text_is_blank(p[blank + 1]))
            add_used(o, material);
        p = end + 1;
    }
    mem_free(text);
    if (o->used.count == 0)
        add_used(o, "");
    return true;
}

static const struct mtl *find(const struct obj_scene *o, const char *name) {
    for (size_t i = o->materials.count; i-- > 0;)
        if (strcmp(LIST_AT(&o->materials, struct mtl, i).name, name) == 0)
            return &LIST_AT(&o->materials, struct mtl, i);
    return NULL;
}

static void widen(struct obj_scene *o, const struct mesh *m) {
    for (uint32_t i = 0; i < m->vertex_count; i++)
        for (int k = 0; k < 3; k++) {
            o->lo[k] = fmin(o->lo[k], m->positions[i][k]);
            o->hi[k] = fmax(o->hi[k], m->positions[i][k]);
        }
}

static bool add_shape(struct obj_scene *o, const char *name) {
    struct reader *r = o->r;
    const struct mesh_options options = {.material_name = o->used.count > 1 ? name : NULL,
                                         .threads = r->options->threads};
    const struct mtl *material = find(o, name);
    struct mesh m;
    if (!mesh_reader_obj.read(o->path, &options, &m))
        return false;
    widen(o, &m);
    const char *id = tree_free_id(r, *name ? arena_printf(r->arena, "%s faces", name) : NULL, "mesh");
    struct xml_node *shape = tree_add_named(r, o->scene, "shape", "made", id);
    tree_integer(r, shape, "shape_index", tree_keep_mesh(r, &m));
    if (*name && !material)
        log_warn("%s: no material \"%s\" was found: it is plain", o->path, name);
    const char *bsdf = material ? mtl_add_bsdf(r, o->scene, material) : NULL;
    if (bsdf)
        tree_ref(r, shape, bsdf);
    if (material && mtl_emits(material)) {
        mtl_add_emitter(r, shape, material);
        o->has_light = true;
    }
    return !material || bsdf;
}

struct xml_node *obj_scene_tree(struct reader *r, const char *path) {
    struct obj_scene o = {.r = r, .scene = tree_add(r, NULL, "scene", NULL, NULL), .path = path};
    for (int k = 0; k < 3; k++) {
        o.lo[k] = INFINITY;
        o.hi[k] = -INFINITY;
    }
    bool ok = load_hash_file(r, path) && scan(&o);
    for (size_t i = 0; ok && i < o.used.count; i++)
        ok = add_shape(&o, LIST_AT(&o.used, const char *, i));
    if (ok)
        tree_add_view(r, o.scene, o.lo, o.hi);
    if (ok && !o.has_light)
        tree_add_sky(r, o.scene);
    mem_free(o.materials.items);
    mem_free(o.used.items);
    return ok ? o.scene : NULL;
}
