// SPDX-License-Identifier: Apache-2.0
// Parameter lists: "type name" [values].
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "scene/pbrt.h"

enum values { NUMBERS, TEXTS, TRUTHS, EITHER };

// The types, the numbers that a value has at least, and what values are.
static const struct value_type {
    const char *name, *also;
    int least;
    enum values values;
} types[] = {
    {"float", "float", 1, NUMBERS},     {"integer", "integer", 1, NUMBERS},
    {"bool", "bool", 1, TRUTHS},        {"string", "string", 1, TEXTS},
    {"texture", "texture", 1, TEXTS},   {"rgb", "color", 3, NUMBERS},
    {"spectrum", "spectrum", 1, EITHER}, {"blackbody", "blackbody", 1, NUMBERS},
    {"point3", "point", 3, NUMBERS},    {"vector3", "vector", 3, NUMBERS},
    {"normal", "normal3", 3, NUMBERS},  {"point2", "point2", 2, NUMBERS},
    {"vector2", "vector2", 2, NUMBERS},
};

static const struct value_type *find_type(const char *name) {
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(types[i].name, name) == 0 || strcmp(types[i].also, name) == 0)
            return &types[i];
    return NULL;
}

void pbrt_free_params(struct list *params) {
    for (size_t i = 0; i < params->count; i++) {
        struct pbrt_param *a = &LIST_AT(params, struct pbrt_param, i);
        mem_free(a->numbers);
        mem_free(a->texts);
    }
    mem_free(params->items);
    *params = (struct list){0};
}

static bool unexpected(const struct pbrt_token *t, const struct pbrt_param *a) {
    char word[64];
    log_error_at(t->at, "found '%s' as a value of \"%s %s\"",
                 t->kind == PBRT_END ? "end of file" : text_excerpt(t->text, word, sizeof word),
                 a->type, a->name);
    return false;
}

// What a value list grows in.
struct growing {
    size_t numbers, texts;
};

static bool add_value(struct pbrt *p, struct pbrt_param *a, const struct value_type *type,
                      const struct pbrt_token *t, struct growing *room) {
    const bool yes = pbrt_token_is(t, "true"), no = pbrt_token_is(t, "false");
    const bool quoted = t->kind == PBRT_STRING;
    const char *at = t->text;
    double v = yes;
    if (type->values == TRUTHS && quoted)
        v = t->size == 4 && memcmp(t->text, "true", 4) == 0;
    else if (type->values == TRUTHS ? !(yes || no) : !quoted &&
             (type->values == TEXTS || t->kind != PBRT_WORD || !text_number(&at, &v) ||
              at != t->text + t->size || !(fabs(v) < 1e300)))
        return unexpected(t, a);
    if (quoted && type->values == NUMBERS)
        return unexpected(t, a);
    if (quoted && type->values != TRUTHS) {
        if (a->numbers)
            return unexpected(t, a);
        mem_grow(&a->texts, &room->texts, a->count + 1, sizeof *a->texts);
        a->texts[a->count++] = arena_printf(p->r->arena, "%.*s", (int)t->size, t->text);
        return true;
    }
    if (a->texts)
        return unexpected(t, a);
    mem_grow(&a->numbers, &room->numbers, a->count + 1, sizeof *a->numbers);
    a->numbers[a->count++] = v;
    return true;
}

static bool read_values(struct pbrt *p, struct pbrt_param *a, const struct value_type *type) {
    struct pbrt_token t;
    struct growing room = {0};
    if (!pbrt_next(p, &t))
        return false;
    if (t.kind != PBRT_OPEN)
        return add_value(p, a, type, &t, &room);
    for (;;) {
        if (!pbrt_next(p, &t))
            return false;
        if (t.kind == PBRT_CLOSE)
            return true;
        if (!add_value(p, a, type, &t, &room))
            return false;
    }
}

// Splits "type name".
static bool read_declaration(struct pbrt *p, const struct pbrt_token *t, struct pbrt_param *a) {
    char *text = arena_printf(p->r->arena, "%.*s", (int)t->size, t->text);
    char *type = text + strspn(text, " \t"), *space = strpbrk(type, " \t");
    if (!*type || !space) {
        log_error_at(t->at, "found \"%s\", expected the type and the name of a parameter", text);
        return false;
    }
    *space = '\0';
    char *name = space + 1 + strspn(space + 1, " \t");
    name[strcspn(name, " \t")] = '\0';
    a->type = type;
    a->name = name;
    a->at = t->at;
    return true;
}

bool pbrt_read_params(struct pbrt *p, struct list *params) {
    for (;;) {
        struct pbrt_token t;
        if (!pbrt_next(p, &t))
            return false;
        if (t.kind != PBRT_STRING) {
            pbrt_put_back(p, &t);
            return true;
        }
        struct pbrt_param *a = LIST_ADD(params, struct pbrt_param);
        if (!read_declaration(p, &t, a))
            return false;
        const struct value_type *type = find_type(a->type);
        if (!type) {
            log_error_at(t.at, "\"%s\" is not a type of parameters", a->type);
            return false;
        }
        a->type = type->name;
        if (!read_values(p, a, type))
            return false;
        if (a->count < (size_t)(a->texts ? 1 : type->least)) {
            log_error_at(a->at, "\"%s %s\" has %zu values, expected %d or more", a->type, a->name,
                         a->count, type->least);
            return false;
        }
    }
}

// Whether one of "a|b|c" is the type.
static bool type_is_in(const char *type, const char *list) {
    const size_t n = strlen(type);
    for (const char *s = list; s; s = strchr(s, '|') ? strchr(s, '|') + 1 : NULL)
        if (strncmp(s, type, n) == 0 && (s[n] == '|' || s[n] == '\0'))
            return true;
    return false;
}

static struct pbrt_param *find_in(const struct list *params, const char *name) {
    for (size_t i = 0; i < params->count; i++)
        if (strcmp(LIST_AT(params, struct pbrt_param, i).name, name) == 0)
            return &LIST_AT(params, struct pbrt_param, i);
    return NULL;
}

const struct pbrt_param *pbrt_find(struct pbrt_call *c, const char *types_wanted, const char *name,
                                   bool *good) {
    struct pbrt_param *a = find_in(&c->params, name);
    for (const struct pbrt_given *g = c->given; g && !a; g = g->outer)
        if (g->target == c->target)
            a = find_in(&g->params, name);
    if (!a)
        return NULL;
    a->used = true;
    if (type_is_in(a->type, types_wanted))
        return a;
    log_error_at(a->at, "%s \"%s\": \"%s\" is of the type %s, expected %s", c->directive, c->type,
                 name, a->type, types_wanted);
    *good = false;
    return NULL;
}

double pbrt_float(struct pbrt_call *c, const char *name, double otherwise, bool *good) {
    const struct pbrt_param *a = pbrt_find(c, "float|integer", name, good);
    return a ? a->numbers[0] : otherwise;
}

int pbrt_integer(struct pbrt_call *c, const char *name, int otherwise, bool *good) {
    const struct pbrt_param *a = pbrt_find(c, "integer", name, good);
    if (!a)
        return otherwise;
    const double v = a->numbers[0];
    if (v == floor(v) && fabs(v) <= INT_MAX)
        return (int)v;
    log_error_at(a->at, "\"%s\" is %g, expected a whole number", name, v);
    *good = false;
    return otherwise;
}

bool pbrt_bool(struct pbrt_call *c, const char *name, bool otherwise, bool *good) {
    const struct pbrt_param *a = pbrt_find(c, "bool", name, good);
    return a ? a->numbers[0] != 0 : otherwise;
}

const char *pbrt_string(struct pbrt_call *c, const char *name, const char *otherwise, bool *good) {
    const struct pbrt_param *a = pbrt_find(c, "string", name, good);
    return a ? a->texts[0] : otherwise;
}

bool pbrt_triple(struct pbrt_call *c, const char *wanted, const char *name, double out[3],
                 bool *good) {
    const struct pbrt_param *a = pbrt_find(c, wanted, name, good);
    if (a)
        memcpy(out, a->numbers, 3 * sizeof *out);
    return a != NULL;
}

void pbrt_report_unused(struct pbrt *p, struct pbrt_call *c) {
    for (size_t i = 0; i < c->params.count; i++) {
        const struct pbrt_param *a = &LIST_AT(&c->params, struct pbrt_param, i);
        if (!a->used)
            pbrt_warn(p, a->at, "%s \"%s\": the parameter \"%s\" is not used", c->directive, c->type,
                      a->name);
    }
}
