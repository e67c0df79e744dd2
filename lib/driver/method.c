// SPDX-License-Identifier: Apache-2.0
#include "driver/method.h"

#include <stdlib.h>
#include <string.h>

// Where the innermost integrator is held.
static struct object **innermost(struct object **slot) {
    for (const struct param *p = (*slot)->type->params; p && p->name; p++) {
        struct object **inner = (void *)((char *)(*slot)->data + p->offset);
        if (p->type == PARAM_INTEGRATOR && *inner)
            return innermost(inner);
    }
    return slot;
}

static size_t size_of(enum param_type type) {
    return type == PARAM_BOOL ? sizeof(bool) : type == PARAM_INT || type == PARAM_CHOICE ? sizeof(int) : 0;
}

// The same object as another type: parameters of the same names are kept, other numbers are what a
// file that does not name them gives.
static struct object *as(const struct object *o, const struct entry *type, struct arena *arena) {
    struct object *out = arena_alloc(arena, sizeof *out);
    *out = *o;
    out->type = type;
    out->data = arena_alloc(arena, type->size);
    for (const struct param *p = type->params; p->name; p++) {
        const struct param *from = param_find(o->type, p->name);
        if (from && from->type == p->type)
            memcpy((char *)out->data + p->offset, (const char *)o->data + from->offset,
                   size_of(p->type));
        else if (p->type == PARAM_INT) {
            const int value = (int)strtol(p->def, NULL, 10);
            memcpy((char *)out->data + p->offset, &value, sizeof value);
        }
    }
    return out;
}

static bool uses_media(const struct scene *s, const struct world *w) {
    bool uses = s->sensor_medium != SCENE_NONE;
    for (uint32_t i = 0; w->boundaries && i < s->shape_count; i++)
        uses |= w->boundaries[i].parts;
    return uses;
}

static bool all_grey(const struct scene *s, const struct world *w) {
    bool grey = true;
    for (uint32_t i = 0; i < s->medium_count; i++)
        grey &= w->media[i].grey;
    return grey;
}

static int max_depth(const struct object *o) {
    int depth;
    memcpy(&depth, (const char *)o->data + param_find(o->type, "max_depth")->offset, sizeof depth);
    return depth;
}

static void replace(struct object **slot, const struct entry *type, const char *why,
                    struct arena *arena, struct method *m) {
    *slot = as(*slot, type, arena);
    m->used = type->name;
    m->why = why;
}

void method_choose(struct scene *s, const struct world *w, struct method *m) {
    struct object **slot = innermost(&s->integrator);
    const struct integrator_type *type = integrator_type_of(*slot);
    *m = (struct method){(*slot)->type->name, (*slot)->type->name, "as asked"};
    if (uses_media(s, w)) {
        if (!type->sees_media && param_find(&type->entry, "max_depth"))
            log_warn_at((*slot)->at, "integrator \"%s\" does not see the scene's media; volpath does",
                        m->asked);
        if (type == &integrator_volpathmis && all_grey(s, w))
            replace(slot, &integrator_volpath.entry, "no medium has a coloured extinction",
                    &s->arena, m);
        return;
    }
    if (!type->sees_media)
        return;
    if (max_depth(*slot) < 0 || !w->shadow_rays_may_pass)
        replace(slot, &integrator_path.entry, "the scene has no media", &s->arena, m);
    else
        m->why = "no media, but a limit of depth that does not count what is passed straight through";
}
