// SPDX-License-Identifier: Apache-2.0
#include "world/attributes.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "texture/texture.h"

// Objects that look up one texture, themselves or by an object inside.
struct wearers {
    const struct object **items;
    size_t count, capacity;
};

static void add(struct wearers *w, const struct object *o) {
    mem_grow(&w->items, &w->capacity, w->count + 1, sizeof *w->items);
    w->items[w->count++] = o;
}

static bool holds(const struct wearers *w, const struct object *o) {
    size_t i = 0;
    while (i < w->count && w->items[i] != o)
        i++;
    return i < w->count;
}

static const struct object *child_of(const struct object *o, const struct param *p) {
    const void *field = (const char *)o->data + p->offset;
    const struct object *child = NULL;
    if (p->type == PARAM_BSDF)
        memcpy(&child, field, sizeof child);
    else if (p->type == PARAM_TEXTURE || p->type == PARAM_TEXTURE_EMISSION ||
             p->type == PARAM_TEXTURE_SCALAR)
        child = ((const struct texture_ref *)field)->texture;
    return child;
}

static void add_if_inside(struct wearers *w, const struct object *o) {
    for (const struct param *p = o->type->params; p && p->name; p++) {
        const struct object *child = child_of(o, p);
        if (child && holds(w, child)) {
            add(w, o);
            return;
        }
    }
}

// Children stand first, so that one pass finds all; a walk down from each shape would take shared
// children as often as there are ways to them.
static void find_wearers(const struct scene *s, uint32_t texture, struct wearers *w) {
    w->count = 0;
    add(w, s->textures[texture]);
    for (uint32_t i = texture + 1; i < s->texture_count; i++)
        add_if_inside(w, s->textures[i]);
    for (uint32_t i = 0; i < s->bsdf_count; i++)
        add_if_inside(w, s->bsdfs[i]);
    for (uint32_t i = 0; i < s->light_count; i++)
        if (s->lights[i].shape != SCENE_NONE)
            add_if_inside(w, s->lights[i].object);
}

static void complain(const struct object *texture, const char *name, const struct shape *shape) {
    const struct mesh *m = &shape->mesh;
    const char *nearest = NULL;
    char hint[256] = "; it has none";
    size_t used = 0;
    int best = 1 << 20;
    for (uint32_t i = 0; i < m->attribute_count; i++)
        name_consider(m->attributes[i].name, m->attributes[i].name, name, &best, &nearest);
    if (nearest)
        snprintf(hint, sizeof hint, "; did you mean \"%s\"?", nearest);
    for (uint32_t i = 0; !nearest && i < m->attribute_count && used < sizeof hint; i++)
        used += (size_t)snprintf(hint + used, sizeof hint - used, "%s %s", i ? "," : "; it has",
                                 m->attributes[i].name);
    log_error_at(texture->at, "%s: the shape \"%s\" of line %d has no attribute \"%s\"%s",
                 texture->type->name, shape->type, shape->at.line, name, hint);
}

bool world_check_attributes(const struct scene *s) {
    struct wearers w = {0};
    bool good = true;
    for (uint32_t t = 0; t < s->texture_count && good; t++) {
        const struct object *texture = s->textures[t];
        const struct texture_type *type = texture_type_of(texture);
        const char *name = type->attribute ? type->attribute(texture->data) : NULL;
        if (!name)
            continue;
        find_wearers(s, t, &w);
        for (uint32_t i = 0; i < s->shape_count && good; i++) {
            const struct shape *shape = &s->shapes[i];
            const bool wears = holds(&w, shape->bsdf) ||
                (shape->light != SCENE_NONE && holds(&w, s->lights[shape->light].object));
            good = !wears || mesh_find_attribute(&shape->mesh, name);
            if (!good)
                complain(texture, name, shape);
        }
    }
    mem_free(w.items);
    return good;
}
