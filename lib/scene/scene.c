// SPDX-License-Identifier: Apache-2.0
#include "scene/scene.h"

#include <string.h>

#include "base/file.h"
#include "scene/formats.h"

// By the file's extension.
static const struct format {
    const char *extension;
    struct xml_node *(*tree)(struct reader *r, const char *path);
} formats[] = {
    {"xml", load_scene_tree},
    {"gltf", gltf_scene_tree},
    {"glb", gltf_scene_tree},
    {"obj", obj_scene_tree},
    {"pbrt", pbrt_scene_tree},
};

static const struct format *find_format(const char *path) {
    char extension[8];
    file_extension(path, extension, sizeof extension);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (strcmp(extension, formats[i].extension) == 0)
            return &formats[i];
    return NULL;
}

bool scene_is_format(const char *path) {
    return find_format(path) != NULL;
}

// What a scene only holds for others to refer to.
static bool is_definition(const struct xml_node *node) {
    static const char *const tags[] = {"bsdf", "texture", "spectrum", "medium", "volume", "phase"};
    for (size_t i = 0; i < sizeof tags / sizeof *tags; i++)
        if (strcmp(node->tag, tags[i]) == 0)
            return true;
    return false;
}

static bool read_child(struct reader *r, struct xml_node *child) {
    struct id_entry *entry;
    struct xml_node *target = id_resolve(r, child, &entry);
    if (!target)
        return false;
    const struct scene_registries *registries = &r->options->registries;
    if (tag_kind(child) == TAG_REF && !is_definition(target)) {
        log_error_at(child->at, "a reference to the <%s> \"%s\" cannot stand directly in a scene",
                     target->tag, xml_get(child, "id"));
        return false;
    }
    if (strcmp(target->tag, "shape") == 0)
        return shape_read(r, target, entry);
    if (strcmp(target->tag, "bsdf") == 0)
        return object_shared(r, registries->bsdfs, &r->bsdfs, target, entry);
    if (strcmp(target->tag, "texture") == 0 && !spectrum_is_type(xml_get(target, "type")))
        return object_shared(r, registries->textures, &r->textures, target, entry);
    if (strcmp(target->tag, "sensor") == 0)
        return sensor_read(r, target, SCENE_NONE);
    if (strcmp(target->tag, "integrator") == 0)
        return integrator_read(r, target);
    if (strcmp(target->tag, "medium") == 0)
        return medium_read(r, target, entry) != SCENE_NONE;
    if (strcmp(target->tag, "volume") == 0)
        return object_shared(r, registries->volumes, &r->volumes, target, entry);
    if (strcmp(target->tag, "phase") == 0)
        return object_shared(r, registries->phases, &r->phases, target, entry);
    if (strcmp(target->tag, "emitter") == 0 || strcmp(target->tag, "spectrum") == 0 ||
        strcmp(target->tag, "texture") == 0)
        return true; // emitters in a second pass, spectra where they are used
    log_error_at(child->at, "a <%s> cannot stand directly in a scene", target->tag);
    return false;
}

// Whether a child is Mitsuba's wish for watertight intersections, which are the default here.
static bool is_watertight(const struct xml_node *child) {
    const char *name = xml_get(child, "name");
    return strcmp(child->tag, "boolean") == 0 && name &&
           strcmp(name, "embree_use_robust_intersections") == 0;
}

// Emitters that no shape has taken.
static bool read_emitter(struct reader *r, struct xml_node *child) {
    const char *id = xml_get(child, "id");
    const struct id_entry *entry = id ? id_find(r, id) : NULL;
    if (strcmp(child->tag, "emitter") != 0 || (entry && entry->state == ID_DONE))
        return true;
    return emitter_read(r, child, SCENE_NONE);
}

static bool read_tree(struct reader *r, struct xml_node *root) {
    for (struct xml_node *c = root->first; c; c = c->next) {
        if (is_watertight(c))
            r->scene->may_leak = strcmp(xml_get(c, "value"), "false") == 0;
        else if (!read_child(r, c))
            return false;
    }
    for (struct xml_node *c = root->first; c; c = c->next)
        if (!read_emitter(r, c))
            return false;
    for (size_t i = 0; i < r->jobs.count; i++) // after the names are known to be right
        if (!load_hash_file(r, LIST_AT(&r->jobs, struct mesh_job, i).path))
            return false;
    return links_resolve(r) && view_defaults(r) && meshes_load(r);
}

// The list's items in the scene's arena, with NULL when there are none.
static void *keep(struct reader *r, const struct list *l, size_t size, uint32_t *count) {
    *count = (uint32_t)l->count;
    if (l->count == 0)
        return NULL;
    return memcpy(arena_alloc(r->arena, l->count * size), l->items, l->count * size);
}

static void finish(struct reader *r) {
    struct scene *s = r->scene;
    s->shapes = keep(r, &r->shapes, sizeof *s->shapes, &s->shape_count);
    s->instances = keep(r, &r->instances, sizeof *s->instances, &s->instance_count);
    s->lights = keep(r, &r->lights, sizeof *s->lights, &s->light_count);
    s->textures = keep(r, &r->textures, sizeof *s->textures, &s->texture_count);
    s->bsdfs = keep(r, &r->bsdfs, sizeof *s->bsdfs, &s->bsdf_count);
    s->volumes = keep(r, &r->volumes, sizeof *s->volumes, &s->volume_count);
    s->phases = keep(r, &r->phases, sizeof *s->phases, &s->phase_count);
    s->media = keep(r, &r->media, sizeof *s->media, &s->medium_count);
    s->sensors = keep(r, &r->sensors, sizeof *s->sensors, &s->sensor_count);
    s->group_count = r->group_count;
    for (size_t i = 0; i < r->made.count; i++)
        mesh_finish(&LIST_AT(&r->made, struct mesh, i)); // those that no shape has taken
    struct list *lists[] = {&r->directories, &r->variables, &r->ids, &r->hashed, &r->ignored,
                            &r->textures, &r->bsdfs, &r->volumes, &r->phases, &r->media, &r->sensors, &r->shapes, &r->instances,
                            &r->lights, &r->jobs, &r->made};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        mem_free(lists[i]->items);
    mem_free(r->id_table);
}

struct scene *scene_read(const char *path, const struct scene_options *options) {
    const struct format *format = find_format(path);
    if (!format) {
        log_error("%s: is not a scene format that is read (xml, gltf, glb, obj, pbrt)", path);
        return NULL;
    }
    struct scene *s = mem_array(1, sizeof *s);
    struct reader r = {.options = options, .scene = s, .arena = &s->arena};
    s->path = arena_strdup(&s->arena, path);
    s->sensor_medium = s->sensor_shape = SCENE_NONE;
    struct xml_node *root = format->tree(&r, s->path);
    const bool ok = root && read_tree(&r, root);
    if (ok)
        ignored_report(&r);
    finish(&r);
    if (ok)
        return s;
    scene_destroy(s);
    return NULL;
}

void scene_destroy(struct scene *s) {
    if (!s)
        return;
    for (uint32_t i = 0; i < s->shape_count; i++)
        mesh_finish(&s->shapes[i].mesh);
    struct arena arena = s->arena; // holds the strings and arrays of s
    mem_free(s);
    arena_finish(&arena);
}
