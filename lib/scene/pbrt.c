// SPDX-License-Identifier: Apache-2.0
// Files of pbrt: blocks, objects, what is included, and the camera that looks at it all.
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "scene/formats.h"
#include "scene/pbrt.h"

enum { MOST_STACK = 1024 };

// ---- blocks ---------------------------------------------------------------------------------------

static bool do_begin(struct pbrt *p, struct where at) {
    if (p->stack.count >= MOST_STACK) {
        log_error_at(at, "blocks are nested more than %d deep", MOST_STACK);
        return false;
    }
    *LIST_ADD(&p->stack, struct pbrt_state) = p->state;
    return true;
}

static bool do_end(struct pbrt *p, struct where at) {
    if (p->stack.count == 0) {
        log_error_at(at, "this block was not begun");
        return false;
    }
    p->state = LIST_AT(&p->stack, struct pbrt_state, --p->stack.count);
    return true;
}

static bool do_object(struct pbrt *p, struct where at) {
    const char *name = pbrt_read_string(p, "the name of an object in quotes");
    if (!name || !do_begin(p, at))
        return false;
    if (p->object) {
        log_error_at(at, "an object inside an object");
        return false;
    }
    p->object = pbrt_add(p, p->scene, "shape", "shapegroup",
                         arena_printf(p->r->arena, "object %s", name), at);
    return p->object != NULL;
}

static bool do_object_end(struct pbrt *p, struct where at) {
    if (!p->object) {
        log_error_at(at, "this object was not begun");
        return false;
    }
    p->object = NULL;
    return do_end(p, at);
}

static bool do_instance(struct pbrt *p, struct where at) {
    const char *name = pbrt_read_string(p, "the name of an object in quotes");
    const char *id = name ? arena_printf(p->r->arena, "object %s", name) : NULL;
    struct transform inverse;
    if (!id)
        return false;
    const struct id_entry *object = id_find(p->r, id);
    if (!object || p->object) {
        log_error_at(at, p->object ? "an instance inside an object"
                                   : "there is no object \"%s\" before this line", name);
        return false;
    }
    if (!transform_is_finite(&p->state.ctm) || !transform_invert(&p->state.ctm, &inverse)) {
        log_error_at(at, "ObjectInstance \"%s\": its transform has no inverse", name);
        return false;
    }
    if (!object->node->first)
        return true;
    struct xml_node *node = pbrt_add(p, p->scene, "shape", "instance", NULL, at);
    pbrt_ref(p, node, NULL, id);
    tree_transform(p->r, node, "to_world", &p->state.ctm);
    return true;
}

static bool do_world(struct pbrt *p, struct where at) {
    if (p->in_world || p->object) {
        log_error_at(at, "WorldBegin stands twice");
        return false;
    }
    p->in_world = true;
    *LIST_ADD(&p->systems, struct pbrt_system) = (struct pbrt_system){"world", transform_identity};
    p->state.ctm = transform_identity;
    return true;
}

static bool do_include(struct pbrt *p, struct where at) {
    const char *name = pbrt_read_string(p, "the name of a file in quotes");
    const char *path = name ? load_find_file(p->r, name, at) : NULL;
    return path && pbrt_open_file(p, path);
}

// ---- the file ---------------------------------------------------------------------------------------

static const struct pbrt_directive blocks[] = {
    {"AttributeBegin", do_begin},
    {"AttributeEnd", do_end},
    {"TransformBegin", do_begin},
    {"TransformEnd", do_end},
    {"ObjectBegin", do_object},
    {"ObjectEnd", do_object_end},
    {"ObjectInstance", do_instance},
    {"Include", do_include},
    {"Import", do_include},
    {"WorldBegin", do_world},
    {0},
};

static bool run(struct pbrt *p, const struct pbrt_token *t) {
    static const struct pbrt_directive *const tables[] = {pbrt_calls, pbrt_transforms, blocks};
    char word[64];
    const char *nearest = NULL;
    int least = 4;
    text_excerpt(t->text, word, sizeof word);
    for (int i = 0; i < 3; i++)
        for (const struct pbrt_directive *d = tables[i]; d->name; d++) {
            if (pbrt_token_is(t, d->name))
                return d->run(p, t->at);
            const int distance = edit_distance(word, d->name);
            if (distance < least) {
                nearest = d->name;
                least = distance;
            }
        }
    log_error_at(t->at, "found '%s', expected a directive%s%s%s", word,
                 nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
    return false;
}

// The camera with its film, filter, sampler and transform.
static bool join_view(struct pbrt *p, const char *path) {
    const struct where at = {path, 0};
    struct transform to_world;
    if (!p->sensor) {
        log_error("%s: has no Camera", path);
        return false;
    }
    if (!p->film) {
        struct pbrt_call plain = {.directive = "Film", .type = "rgb", .at = at,
                                  .target = PBRT_NO_TARGET};
        p->film = pbrt_add(p, NULL, "film", NULL, NULL, at);
        pbrt_make(p, pbrt_films, &plain, p->film);
    }
    if (!transform_is_finite(&p->camera) || !transform_invert(&p->camera, &to_world)) {
        log_error_at(p->sensor->at, "Camera: its transform has no inverse");
        return false;
    }
    double size = 1; // of orthographic ones: the shorter side spans -1 to 1
    if (strcmp(xml_get(p->sensor, "type"), "orthographic") == 0)
        size = fmax((double)p->width / p->height, 1);
    const struct transform ours = transform_scale(-size, size, 1);
    to_world = transform_multiply(&to_world, &ours);
    p->r->place = p->sensor->at;
    tree_transform(p->r, p->sensor, "to_world", &to_world);
    if (p->filter)
        xml_append(p->film, p->filter);
    xml_append(p->sensor, p->film);
    if (p->sampler)
        xml_append(p->sensor, p->sampler);
    if (p->camera_medium)
        pbrt_ref(p, p->sensor, NULL, p->camera_medium);
    xml_append(p->scene, p->sensor);
    if (!p->has_integrator) { // volpath of maxdepth 5
        struct xml_node *integrator = pbrt_add(p, p->scene, "integrator", "volpath", NULL, at);
        tree_integer(p->r, integrator, "max_depth", 6);
    }
    return true;
}

static bool read_all(struct pbrt *p, const char *path) {
    struct pbrt_token t;
    if (!pbrt_open_file(p, path))
        return false;
    for (;;) {
        if (!pbrt_next(p, &t))
            return false;
        if (t.kind == PBRT_END)
            break;
        if (!run(p, &t))
            return false;
    }
    if (p->stack.count > 0 || !p->in_world) {
        log_error_at(t.at, "the file ends %s", p->in_world ? "inside a block" : "before WorldBegin");
        return false;
    }
    return join_view(p, path);
}

static void finish(struct pbrt *p) {
    for (size_t i = 0; i < p->area_lights.count; i++) {
        struct pbrt_call *c = LIST_AT(&p->area_lights, struct pbrt_call *, i);
        pbrt_free_params(&c->params);
        mem_free(c);
    }
    for (struct pbrt_given *g = p->all_given, *next; g; g = next) {
        next = g->next;
        pbrt_free_params(&g->params);
        mem_free(g);
    }
    pbrt_close_files(p);
    mem_free(p->area_lights.items);
    mem_free(p->systems.items);
    mem_free(p->stack.items);
    mem_free(p->warned.items);
}

struct xml_node *pbrt_scene_tree(struct reader *r, const char *path) {
    struct pbrt p = {.r = r, .scene = tree_add(r, NULL, "scene", NULL, NULL)};
    p.state.ctm = p.camera = transform_identity;
    char folder[4096];
    file_directory(path, folder, sizeof folder);
    *LIST_ADD(&r->directories, const char *) = arena_strdup(r->arena, folder);
    const bool good = read_all(&p, path);
    finish(&p);
    r->place = (struct where){0};
    return good ? p.scene : NULL;
}
