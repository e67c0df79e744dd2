// SPDX-License-Identifier: Apache-2.0
// Light linking: which shapes a light lights, from lists of ids and groups of shapes.
#include <string.h>

#include "scene/reader.h"

static bool is_called(const struct shape *s, const char *name, size_t n) {
    return (strlen(s->name) == n && strncmp(s->name, name, n) == 0) ||
           (s->set && strlen(s->set) == n && strncmp(s->set, name, n) == 0);
}

// Marks the shapes of that name; false: there are none.
static bool mark(const struct list *shapes, const char *name, size_t n, uint8_t value,
                 uint8_t *dark) {
    bool found = false;
    for (size_t i = 0; i < shapes->count; i++)
        if (is_called(&LIST_AT(shapes, struct shape, i), name, n)) {
            dark[i] = value;
            found = true;
        }
    return found;
}

static bool read_list(const struct list *shapes, const struct scene_light *l, uint8_t *dark) {
    const uint8_t value = l->exclude != NULL;
    memset(dark, !value, shapes->count);
    for (const char *s = l->include ? l->include : l->exclude; *s;) {
        s += strspn(s, " ,");
        size_t n = strcspn(s, ",");
        const char *next = s + n;
        while (n > 0 && s[n - 1] == ' ')
            n--;
        if (n > 0 && !mark(shapes, s, n, value, dark)) {
            log_error_at(l->object->at, "%s: no shape has the id or group \"%.*s\" (instances take "
                         "the links of the shapes in their shapegroup)",
                         l->include ? "include" : "exclude", (int)n, s);
            return false;
        }
        s = next;
    }
    return true;
}

bool links_resolve(struct reader *r) {
    for (size_t i = 0; i < r->lights.count; i++) {
        struct scene_light *l = &LIST_AT(&r->lights, struct scene_light, i);
        if (l->include && l->exclude) {
            log_error_at(l->object->at, "a light takes a list to include or to exclude, not both");
            return false;
        }
        if (!l->include && !l->exclude)
            continue;
        uint8_t *dark = arena_alloc(r->arena, r->shapes.count + 1);
        if (!read_list(&r->shapes, l, dark))
            return false;
        l->dark = dark;
    }
    return true;
}
