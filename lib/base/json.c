// SPDX-License-Identifier: Apache-2.0
// The only file that knows jansson: a struct json is a json_t. Its macros json_is_object and
// json_is_array give way to functions of the same names and meaning.
#include <jansson.h>
#undef json_is_object
#undef json_is_array

#include "base/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"

static json_t *own(struct json *v) {
    return (json_t *)v;
}

static const json_t *see(const struct json *v) {
    return (const json_t *)v;
}

// jansson gives NULL only when memory runs out (or a text is not UTF-8: the caller below sees to
// that).
static json_t *made(json_t *v) {
    if (!v) {
        log_error("out of memory while building JSON");
        abort();
    }
    return v;
}

static json_t *make_number(double v) {
    return made(isfinite(v) ? json_real(v) : json_null());
}

// File names need not be UTF-8: other bytes become '?'.
static json_t *make_text(const char *text) {
    json_t *v = text ? json_string(text) : json_null();
    if (v)
        return v;
    char *ascii = strdup(text);
    for (char *c = ascii; c && *c; c++)
        if ((unsigned char)*c >= 128)
            *c = '?';
    v = ascii ? json_string(ascii) : NULL;
    free(ascii);
    return made(v);
}

struct json *json_new_object(void) {
    return (struct json *)made(json_object());
}

struct json *json_new_array(void) {
    return (struct json *)made(json_array());
}

struct json *json_clone(const struct json *root) {
    return (struct json *)made(json_deep_copy(see(root)));
}

void json_destroy(struct json *root) {
    json_decref(own(root));
}

static json_t *set(struct json *object, const char *key, json_t *value) {
    json_object_set_new(own(object), key, value);
    return value;
}

static json_t *append(struct json *array, json_t *value) {
    json_array_append_new(own(array), value);
    return value;
}

void json_add_number(struct json *object, const char *key, double value) {
    set(object, key, make_number(value));
}

void json_add_count(struct json *object, const char *key, int64_t value) {
    set(object, key, made(json_integer(value)));
}

void json_add_bool(struct json *object, const char *key, bool value) {
    set(object, key, value ? json_true() : json_false());
}

void json_add_text(struct json *object, const char *key, const char *value) {
    set(object, key, make_text(value));
}

struct json *json_add_object(struct json *object, const char *key) {
    return (struct json *)set(object, key, made(json_object()));
}

struct json *json_add_array(struct json *object, const char *key) {
    return (struct json *)set(object, key, made(json_array()));
}

void json_append_count(struct json *array, int64_t value) {
    json_array_append_new(own(array), made(json_integer(value)));
}

void json_append_number(struct json *array, double value) {
    append(array, make_number(value));
}

void json_append_text(struct json *array, const char *value) {
    append(array, make_text(value));
}

struct json *json_append_object(struct json *array) {
    return (struct json *)append(array, made(json_object()));
}

struct json *json_append_array(struct json *array) {
    return (struct json *)append(array, made(json_array()));
}

void json_print(const struct json *root, bool indented) {
    json_dumpf(see(root), stdout, JSON_REAL_PRECISION(15) | (indented ? JSON_INDENT(2) : 0));
    putchar('\n');
    fflush(stdout); // a reader of a long run wants each line when it is there
}

char *json_to_text(const struct json *root) {
    const size_t flags = JSON_REAL_PRECISION(17) | JSON_ENCODE_ANY;
    const size_t size = json_dumpb(see(root), NULL, 0, flags);
    char *text = mem_array(size + 1, 1);
    json_dumpb(see(root), text, size, flags);
    return text;
}

static bool is_plain(const json_t *v) {
    return json_typeof(v) != JSON_OBJECT && json_typeof(v) != JSON_ARRAY;
}

static void print_plain(const json_t *v) {
    switch (json_typeof(v)) {
    case JSON_STRING: printf("%s", json_string_value(v)); break;
    case JSON_INTEGER: printf("%lld", (long long)json_integer_value(v)); break;
    case JSON_REAL: printf("%.9g", json_real_value(v)); break;
    case JSON_TRUE: printf("yes"); break;
    case JSON_FALSE: printf("no"); break;
    default: printf("none"); break;
    }
}

static void print_members(const json_t *object, int indent);

static void print_items(const json_t *array, int indent) {
    for (size_t i = 0; i < json_array_size(array); i++) {
        const json_t *item = json_array_get(array, i);
        if (is_plain(item)) {
            putchar(' ');
            print_plain(item);
        } else {
            putchar('\n');
            print_members(item, indent);
        }
    }
}

static bool is_row(const json_t *object) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value) {
        if (!is_plain(value))
            return false;
    }
    return true;
}

// An object of plain values inside an array is one line.
static void print_row(const json_t *object, int indent) {
    const char *key;
    json_t *value;
    printf("%*s", indent, "");
    json_object_foreach((json_t *)object, key, value) {
        printf("%s ", key);
        print_plain(value);
        printf("  ");
    }
}

static void print_members(const json_t *object, int indent) {
    const char *key;
    json_t *value;
    if (indent > 0 && is_row(object)) {
        print_row(object, indent);
        return;
    }
    json_object_foreach((json_t *)object, key, value) {
        printf("%*s%s:", indent, "", key);
        if (json_typeof(value) == JSON_ARRAY) {
            print_items(value, indent + 2);
        } else if (json_typeof(value) == JSON_OBJECT) {
            const char *name;
            json_t *member;
            json_object_foreach(value, name, member) {
                printf("\n%*s%s:", indent + 2, "", name);
                if (json_typeof(member) == JSON_ARRAY) {
                    print_items(member, indent + 4);
                } else if (is_plain(member)) {
                    putchar(' ');
                    print_plain(member);
                }
            }
        } else {
            putchar(' ');
            print_plain(value);
        }
        putchar('\n');
    }
}

void json_print_lines(const struct json *root) {
    print_members(see(root), 0);
}

bool json_write(const struct json *root, const char *path) {
    char *text = json_dumps(see(root), JSON_REAL_PRECISION(15) | JSON_INDENT(2));
    if (!text) {
        log_error("%s: cannot be written: out of memory", path);
        return false;
    }
    const bool good = file_write(path, text, strlen(text));
    free(text);
    return good;
}

struct json *json_parse(const char *text, size_t size, const char *path) {
    json_error_t e;
    json_t *v = json_loadb(text, size, JSON_REJECT_DUPLICATES, &e);
    if (!v)
        log_error_at((struct where){path, e.line}, "is not valid JSON: %s", e.text);
    return (struct json *)v;
}

const struct json *json_get(const struct json *object, const char *key) {
    return (const struct json *)json_object_get(see(object), key);
}

const struct json *json_at(const struct json *array, size_t i) {
    return (const struct json *)json_array_get(see(array), i);
}

size_t json_count(const struct json *container) {
    return json_is_array(container) ? json_array_size(see(container))
                                    : json_object_size(see(container));
}

const char *json_key(const struct json *object, size_t i) {
    void *it = json_object_iter((json_t *)see(object));
    for (; it && i > 0; i--)
        it = json_object_iter_next((json_t *)see(object), it);
    return it ? json_object_iter_key(it) : NULL;
}

bool json_is_object(const struct json *value) {
    return value && json_typeof(see(value)) == JSON_OBJECT;
}

bool json_is_array(const struct json *value) {
    return value && json_typeof(see(value)) == JSON_ARRAY;
}

const char *json_text(const struct json *value) {
    return json_string_value(see(value));
}

bool json_read_number(const struct json *value, double *out) {
    if (!json_is_number(see(value)))
        return false;
    *out = json_number_value(see(value));
    return true;
}

bool json_read_integer(const struct json *value, int64_t *out) {
    if (!json_is_integer(see(value)))
        return false;
    *out = json_integer_value(see(value));
    return true;
}

bool json_read_bool(const struct json *value, bool *out) {
    if (!json_is_boolean(see(value)))
        return false;
    *out = json_is_true(see(value));
    return true;
}
