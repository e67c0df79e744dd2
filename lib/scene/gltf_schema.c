// SPDX-License-Identifier: Apache-2.0
// Holds a glTF file to the tables of what its objects may hold (scene/gltf_rules.h).
#include <math.h>
#include <string.h>

#include "scene/gltf.h"
#include "scene/gltf_rules.h"

static bool check_object(struct gltf *g, const struct json *value, const struct gltf_object_rule *o,
                         const char *at);

// The collection an index points into: one of the file, or EXTENSION/NAME.
static size_t collection_size(const struct gltf *g, const char *name) {
    const char *slash = strchr(name, '/');
    if (!slash)
        return json_count(json_get(g->root, name));
    const char *extension = arena_printf(g->arena, "%.*s", (int)(slash - name), name);
    return json_count(json_get(gltf_extension(g->root, extension), slash + 1));
}

static bool check_number(struct gltf *g, const struct json *value, const struct gltf_rule *r,
                         const char *at) {
    double v;
    if (!json_read_number(value, &v))
        return gltf_fail(g, at, "is not a number");
    if (r->kind != NUMBER && r->kind != NUMBERS && v != floor(v))
        return gltf_fail(g, at, "is %g, expected a whole number", v);
    if (!isfinite(v) || (r->min < r->max && !(v >= r->min && v <= r->max)))
        return gltf_fail(g, at, "is %g, expected %g to %g", v, r->min, r->max);
    if (r->into && !(v >= 0 && v < (double)collection_size(g, r->into)))
        return gltf_fail(g, at, "is %g, but there are %zu %s", v, collection_size(g, r->into),
                         r->into);
    return true;
}

static bool check_array(struct gltf *g, const struct json *value, const struct gltf_rule *r,
                        const char *at) {
    if (!json_is_array(value))
        return gltf_fail(g, at, "is not an array");
    const size_t n = json_count(value);
    if (n < (size_t)r->least || (r->most > 0 && n > (size_t)r->most))
        return gltf_fail(g, at, "has %zu items, expected at least %d%s", n, r->least,
                         r->most > 0 ? " and no more than it takes" : "");
    for (size_t i = 0; i < n; i++) {
        const struct json *item = json_at(value, i);
        const char *here = arena_printf(g->arena, "%s/%zu", at, i);
        const bool ok = r->kind == OBJECTS ? check_object(g, item, r->of, here)
                        : r->kind == TEXTS ? json_text(item) || gltf_fail(g, here, "is not a text")
                                           : check_number(g, item, r, here);
        if (!ok)
            return false;
    }
    return true;
}

static bool check_property(struct gltf *g, const struct json *value, const struct gltf_rule *r,
                           const char *at) {
    bool flag;
    switch (r->kind) {
    case NUMBER:
    case INDEX:
    case COUNT: return check_number(g, value, r, at);
    case TEXT: return json_text(value) || gltf_fail(g, at, "is not a text");
    case FLAG: return json_read_bool(value, &flag) || gltf_fail(g, at, "is neither true nor false");
    case OBJECT: return check_object(g, value, r->of, at);
    case ANY: return true;
    default: return check_array(g, value, r, at);
    }
}

static bool is_declared(const struct gltf *g, const char *extension) {
    const struct json *used = json_get(g->root, "extensionsUsed");
    for (size_t i = 0; i < json_count(used); i++) {
        const char *name = json_text(json_at(used, i));
        if (name && strcmp(name, extension) == 0)
            return true;
    }
    return false;
}

// Extensions that the tables know may stand only where they belong.
static bool is_misplaced(struct gltf *g, const char *name, const struct gltf_object_rule *o) {
    const char *word = arena_printf(g->arena, " %s ", name);
    bool known = false;
    for (const struct gltf_object_rule *const *p = gltf_extensible_rules; *p; p++)
        known |= strstr((*p)->extensions, word) != NULL;
    return known && !strstr(o->extensions, word);
}

static bool check_extension(struct gltf *g, const struct json *value, const char *name,
                            const struct gltf_object_rule *o, const char *at) {
    if (!json_is_object(value))
        return gltf_fail(g, at, "is not an object");
    if (!is_declared(g, name))
        return gltf_fail(g, at, "is not declared in extensionsUsed");
    if (is_misplaced(g, name, o))
        return gltf_fail(g, at, "cannot stand here");
    for (const struct gltf_extension_rule *e = gltf_extension_rules; e->name; e++)
        if (e->where == o && strcmp(e->name, name) == 0)
            return check_object(g, value, e->of, at);
    return true;
}

static bool check_extensions(struct gltf *g, const struct json *object,
                             const struct gltf_object_rule *o, const char *at) {
    const struct json *extensions = json_get(object, "extensions");
    if (!extensions)
        return true;
    const char *here = arena_printf(g->arena, "%s/extensions", at);
    if (!json_is_object(extensions))
        return gltf_fail(g, here, "is not an object");
    for (size_t i = 0; i < json_count(extensions); i++) {
        const char *name = json_key(extensions, i);
        if (!check_extension(g, json_get(extensions, name), name, o,
                             arena_printf(g->arena, "%s/%s", here, name)))
            return false;
    }
    return true;
}

static bool check_object(struct gltf *g, const struct json *value, const struct gltf_object_rule *o,
                         const char *at) {
    if (!json_is_object(value))
        return gltf_fail(g, *at ? at : "/", "is not an object");
    for (const struct gltf_rule *r = o->rules; r->name; r++) {
        const struct json *property = json_get(value, r->name);
        if (property && !check_property(g, property, r,
                                        arena_printf(g->arena, "%s/%s", at, r->name)))
            return false;
        if (!property && r->required)
            return gltf_fail(g, *at ? at : "/", "lacks \"%s\"", r->name);
    }
    return check_extensions(g, value, o, at);
}

bool gltf_check_schema(struct gltf *g) {
    return check_object(g, g->root, &gltf_root_rule, "");
}
