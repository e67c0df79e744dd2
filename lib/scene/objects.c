// SPDX-License-Identifier: Apache-2.0
// Objects of the registries from elements, by parameter table alone.
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "scene/params.h"

enum { MOST_DEPTH = 64, MOST_PARAMS = 128 };

struct ignored_name {
    const char *name;
    struct where at; // of the first
};

void ignore_name(struct reader *r, const char *name, struct where at) {
    for (size_t i = 0; i < r->ignored.count; i++)
        if (strcmp(LIST_AT(&r->ignored, struct ignored_name, i).name, name) == 0)
            return;
    *LIST_ADD(&r->ignored, struct ignored_name) = (struct ignored_name){name, at};
}

void ignore_child_name(struct reader *r, const struct xml_node *child,
                       const struct xml_node *target) {
    const char *name = child->old_name ? child->old_name : xml_get(child, "name");
    if (name && strcmp(name, target->tag) != 0)
        ignore_name(r, arena_printf(r->arena, "name=\"%s\"", name), child->at);
}

void ignored_report(const struct reader *r) {
    char names[1024];
    size_t used = 0;
    for (size_t i = 0; i < r->ignored.count; i++) {
        const struct ignored_name *n = &LIST_AT(&r->ignored, struct ignored_name, i);
        const int k = snprintf(names + used, sizeof names - used, "%s%s (line %d)",
                               used ? ", " : "", n->name, n->at.line);
        if (k < 0 || (size_t)k >= sizeof names - used)
            break;
        used += (size_t)k;
    }
    if (used)
        log_info("%s: accepted without effect: %s", r->scene->path, names);
}

// ---- cycles and depth -----------------------------------------------------------------------

bool object_enter(struct reader *r, const struct xml_node *target, struct id_entry *entry) {
    if (entry && entry->state == ID_OPEN) {
        log_error_at(target->at, "\"%s\" contains itself", entry->id);
        return false;
    }
    if (r->depth >= MOST_DEPTH) {
        log_error_at(target->at, "objects are nested more than %d deep", MOST_DEPTH);
        return false;
    }
    r->depth++;
    if (entry)
        entry->state = ID_OPEN;
    return true;
}

void object_leave(struct reader *r, struct id_entry *entry) {
    r->depth--;
    if (entry)
        entry->state = ID_DONE;
}

// ---- filling --------------------------------------------------------------------------------

struct fill {
    struct reader *r;
    const struct xml_node *node;
    const struct entry *e;
    void *data;
    bool drop_unknown;
    bool set[MOST_PARAMS];
};

static bool unknown_parameter(const struct fill *f, const struct xml_node *child,
                              const char *name) {
    if (f->drop_unknown)
        return true;
    const char *nearest = param_nearest(f->e, name);
    char hint[256] = "";
    if (nearest)
        snprintf(hint, sizeof hint, "; did you mean \"%s\"?",
                 dialect_spelling(child, nearest, f->r->arena));
    else {
        size_t used = (size_t)snprintf(hint, sizeof hint, "; it has:");
        for (const struct param *p = f->e->params; p && p->name; p++)
            if (p->type != PARAM_IGNORED && used + strlen(p->name) + 2 < sizeof hint)
                used += (size_t)snprintf(hint + used, sizeof hint - used, " %s",
                                         dialect_spelling(child, p->name, f->r->arena));
    }
    if (child->old_name)
        name = child->old_name;
    if (f->r->options->lenient) {
        log_warn_at(child->at, "%s \"%s\" has no parameter \"%s\"%s", f->node->tag,
                    xml_get(f->node, "type"), name, hint);
        return true;
    }
    log_error_at(child->at, "%s \"%s\" has no parameter \"%s\"%s", f->node->tag,
                 xml_get(f->node, "type"), name, hint);
    return false;
}

static bool claim(struct fill *f, const struct param *p, const struct xml_node *child) {
    bool *set = &f->set[p - f->e->params];
    if (*set)
        log_error_at(child->at, "\"%s\" is given twice", p->name);
    const bool fresh = !*set;
    *set = true;
    return fresh;
}

static bool fill_value(struct fill *f, const struct xml_node *child) {
    const char *name = xml_get(child, "name");
    if (!name) {
        log_error_at(child->at, "<%s> cannot stand directly in %s \"%s\"", child->tag,
                     f->node->tag, xml_get(f->node, "type"));
        return false;
    }
    const struct param *p = param_find(f->e, name);
    if (!p)
        return unknown_parameter(f, child, name);
    return claim(f, p, child) && param_read_value(f->r, child, p, f->data);
}

// The slot of a nested object: by name, else the first free one that accepts it.
static const struct param *find_slot(const struct fill *f, const struct xml_node *target,
                                     const char *name) {
    const struct param *named = name ? param_find(f->e, name) : NULL;
    const bool by_name = name && (strcmp(target->tag, "texture") == 0 ||
                                  strcmp(target->tag, "spectrum") == 0);
    if (named && (by_name || param_accepts(named, target) || named->type == PARAM_IGNORED))
        return named;
    for (const struct param *p = f->e->params; !by_name && p && p->name; p++)
        if (!f->set[p - f->e->params] && param_accepts(p, target))
            return p;
    return NULL;
}

static bool fill_object(struct fill *f, struct xml_node *child, child_fn other, void *ctx) {
    struct id_entry *entry;
    struct xml_node *target = id_resolve(f->r, child, &entry);
    if (!target)
        return false;
    const char *name = xml_get(child, "name");
    const struct param *p = find_slot(f, target, name);
    if (p && p->type == PARAM_IGNORED) {
        ignore_name(f->r, p->name, child->at);
        return true;
    }
    if (p && !param_accepts(p, target)) {
        log_error_at(child->at, "\"%s\" cannot be a %s", p->name, target->tag);
        return false;
    }
    if (p && name && param_find(f->e, name) != p)
        ignore_child_name(f->r, child, target);
    if (p)
        return claim(f, p, child) &&
               param_read_object(f->r, child->at, target, entry, p, f->data);
    if (other)
        return other(f->r, child, target, entry, ctx);
    if (name || f->drop_unknown)
        return unknown_parameter(f, child, name);
    log_error_at(child->at, "%s \"%s\" has no place for a %s", f->node->tag,
                 xml_get(f->node, "type"), target->tag);
    return false;
}

bool object_fill(struct reader *r, const struct xml_node *node, const struct entry *e, void *data,
                 bool drop_unknown, child_fn other, void *ctx) {
    struct fill f = {r, node, e, data, drop_unknown, {false}};
    for (const struct param *p = e->params; p && p->name; p++)
        assert(p - e->params < MOST_PARAMS);
    for (struct xml_node *child = node->first; child; child = child->next) {
        const bool is_value = tag_kind(child) == TAG_VALUE;
        if (!(is_value ? fill_value(&f, child) : fill_object(&f, child, other, ctx)))
            return false;
    }
    for (const struct param *p = e->params; p && p->name; p++)
        if (!f.set[p - e->params] && !param_read_default(r, node, p, data))
            return false;
    return true;
}

// ---- making ---------------------------------------------------------------------------------

const struct entry *object_entry(const struct registry *registry, const struct xml_node *node) {
    const char *type = xml_get(node, "type");
    const struct entry *e = registry_find(registry, type);
    const char *nearest = e ? NULL : registry_nearest(registry, type);
    if (nearest)
        log_error_at(node->at, "%s \"%s\" is not known; did you mean \"%s\"?", registry->kind, type,
                     nearest);
    else if (!e)
        log_error_at(node->at, "%s \"%s\" is not known; relume help %s lists those that are",
                     registry->kind, type, registry->kind);
    return e;
}

struct object *object_make_as(struct reader *r, const struct entry *e, const struct xml_node *node,
                              bool drop_unknown, child_fn other, void *ctx) {
    struct object *o = arena_alloc(r->arena, sizeof *o);
    o->type = e;
    o->data = arena_alloc(r->arena, e->size ? e->size : 1);
    o->id = xml_get(node, "id");
    o->at = node->at;
    return object_fill(r, node, e, o->data, drop_unknown, other, ctx) ? o : NULL;
}

struct object *object_make(struct reader *r, const struct registry *registry,
                           const struct xml_node *node, child_fn other, void *ctx) {
    const struct entry *e = object_entry(registry, node);
    return e ? object_make_as(r, e, node, false, other, ctx) : NULL;
}

struct object *object_shared(struct reader *r, const struct registry *registry,
                             struct list *list, struct xml_node *target, struct id_entry *entry) {
    if (entry && entry->object)
        return entry->object;
    if (!object_enter(r, target, entry))
        return NULL;
    struct object *o = object_make(r, registry, target, NULL, NULL);
    object_leave(r, entry);
    if (!o)
        return NULL;
    *LIST_ADD(list, struct object *) = o;
    if (entry)
        entry->object = o;
    return o;
}

const char *node_take_value(struct reader *r, struct xml_node *node, const char *name) {
    const char *key = arena_printf(r->arena, "taken %s", name); // no attribute of a file has blanks
    struct xml_node *previous = NULL;
    for (struct xml_node *c = node->first; c; previous = c, c = c->next) {
        const char *child_name = xml_get(c, "name");
        if (tag_kind(c) != TAG_VALUE || !child_name || strcmp(child_name, name) != 0)
            continue;
        if (previous)
            previous->next = c->next;
        else
            node->first = c->next;
        if (node->last == c)
            node->last = previous;
        xml_set(node, key, xml_get(c, "value"), r->arena);
        break;
    }
    return xml_get(node, key);
}
