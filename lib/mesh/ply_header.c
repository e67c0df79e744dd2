// SPDX-License-Identifier: Apache-2.0
#include "mesh/ply_header.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/text.h"

enum { MOST_TOKENS = 6, MOST_TOKEN = 64 };

struct line {
    char tokens[MOST_TOKENS][MOST_TOKEN];
    int count; // MOST_TOKENS also when there are more
};

static const struct {
    const char *name, *name2;
    size_t size;
} types[] = {
    [PLY_INT8] = {"char", "int8", 1},      [PLY_UINT8] = {"uchar", "uint8", 1},
    [PLY_INT16] = {"short", "int16", 2},   [PLY_UINT16] = {"ushort", "uint16", 2},
    [PLY_INT32] = {"int", "int32", 4},     [PLY_UINT32] = {"uint", "uint32", 4},
    [PLY_INT64] = {"long", "int64", 8},    [PLY_UINT64] = {"ulong", "uint64", 8},
    [PLY_FLOAT32] = {"float", "float32", 4}, [PLY_FLOAT64] = {"double", "float64", 8},
};

size_t ply_type_size(enum ply_type type) {
    return types[type].size;
}

bool ply_type_is_integer(enum ply_type type) {
    return type < PLY_FLOAT32;
}

const char *ply_type_name(enum ply_type type) {
    return types[type].name;
}

static enum ply_type find_type(const char *name) {
    int t = 0;
    while (t < PLY_NONE && strcmp(name, types[t].name) != 0 && strcmp(name, types[t].name2) != 0)
        t++;
    return (enum ply_type)t;
}

// One line up to "\n", "\r\n" or "\r"; p behind it. Overlong tokens are cut, which makes them
// unknown words.
static const char *split_line(const char *p, struct line *l) {
    l->count = 0;
    for (;;) {
        while (text_is_blank(*p))
            p++;
        if (*p == '\0')
            return p;
        if (*p == '\n' || *p == '\r')
            return p + (p[0] == '\r' && p[1] == '\n' ? 2 : 1);
        const size_t n = strcspn(p, " \t\r\n");
        if (l->count < MOST_TOKENS)
            snprintf(l->tokens[l->count++], MOST_TOKEN, "%.*s",
                     (int)(n < MOST_TOKEN ? n : MOST_TOKEN), p);
        p += n;
    }
}

static bool fail(struct where at, const struct line *l, int token, const char *expected) {
    char found[MOST_TOKEN];
    log_error_at(at, "found '%s', expected %s",
                 token < l->count ? text_excerpt(l->tokens[token], found, sizeof found)
                                  : "end of line",
                 expected);
    return false;
}

static bool read_format(struct ply_header *h, const struct line *l, struct where at) {
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    int f = 0;
    while (f < 3 && l->count > 1 && strcmp(l->tokens[1], names[f]) != 0)
        f++;
    if (l->count < 2 || f == 3)
        return fail(at, l, 1, "ascii, binary_little_endian or binary_big_endian");
    if (l->count < 3 || strcmp(l->tokens[2], "1.0") != 0)
        return fail(at, l, 2, "the version 1.0");
    h->format = (enum ply_format)f;
    return l->count == 3 || fail(at, l, 3, "the end of the line");
}

static bool read_element(struct ply_header *h, const struct line *l, struct where at) {
    if (l->count < 2 || strlen(l->tokens[1]) >= PLY_MOST_NAME)
        return fail(at, l, 1, "the name of an element (at most 39 characters)");
    if (ply_find_element(h, l->tokens[1]))
        return fail(at, l, 1, "an element that did not stand before");
    const char *end = l->tokens[2];
    int64_t count = -1;
    if (l->count < 3 || *end == '+' || !text_integer(&end, &count) || *end || count < 0 ||
        count >= UINT32_MAX)
        return fail(at, l, 2, "a count from 0 to 4294967294");
    if (l->count > 3)
        return fail(at, l, 3, "the end of the line");
    if (h->element_count == PLY_MOST_ELEMENTS)
        return fail(at, l, 0, "at most 32 elements");
    struct ply_element *e = &h->elements[h->element_count++];
    *e = (struct ply_element){.count = (uint32_t)count, .first = h->property_count};
    strcpy(e->name, l->tokens[1]);
    return true;
}

static bool read_property(struct ply_header *h, const struct line *l, struct where at) {
    const bool list = l->count > 1 && strcmp(l->tokens[1], "list") == 0;
    const int name = list ? 4 : 2;
    if (h->element_count == 0)
        return fail(at, l, 0, "an element before its properties");
    if (h->property_count == PLY_MOST_PROPERTIES)
        return fail(at, l, 0, "at most 256 properties");
    struct ply_property *q = &h->properties[h->property_count];
    q->count_type = list && l->count > 2 ? find_type(l->tokens[2]) : PLY_NONE;
    if (list && (q->count_type == PLY_NONE || !ply_type_is_integer(q->count_type)))
        return fail(at, l, 2, "an integer type (char, uchar, short, ushort, int, uint)");
    q->type = l->count > name - 1 ? find_type(l->tokens[name - 1]) : PLY_NONE;
    if (q->type == PLY_NONE)
        return fail(at, l, name - 1,
                    "a type (char, uchar, short, ushort, int, uint, float, double)");
    if (l->count <= name || strlen(l->tokens[name]) >= PLY_MOST_NAME)
        return fail(at, l, name, "the name of a property (at most 39 characters)");
    if (l->count > name + 1)
        return fail(at, l, name + 1, "the end of the line");
    strcpy(q->name, l->tokens[name]);
    h->property_count++;
    h->elements[h->element_count - 1].property_count++;
    return true;
}

bool ply_read_header(const char *path, const char *text, size_t size, struct ply_header *h) {
    struct where at = {path, 1};
    struct line l;
    const char *p = split_line(text, &l);
    bool formatted = false;
    *h = (struct ply_header){0};
    if (l.count != 1 || strcmp(l.tokens[0], "ply") != 0)
        return fail(at, &l, 0, "the word ply");
    for (;;) {
        at.line++;
        if (p >= text + size || at.line == INT_MAX) {
            log_error_at(at, "found the end of the file, expected end_header");
            return false;
        }
        if (*p == '\0')
            return fail(at, &l, l.count, "text, not a zero byte");
        p = split_line(p, &l);
        const char *word = l.count ? l.tokens[0] : "comment";
        if (strcmp(word, "comment") == 0 || strcmp(word, "obj_info") == 0)
            continue;
        if (strcmp(word, "end_header") == 0)
            break;
        const bool is_format = strcmp(word, "format") == 0;
        if (is_format == formatted)
            return fail(at, &l, 0, formatted ? "one format line" : "the format line first");
        formatted = true;
        if (!(is_format ? read_format(h, &l, at)
              : strcmp(word, "element") == 0  ? read_element(h, &l, at)
              : strcmp(word, "property") == 0 ? read_property(h, &l, at)
                : fail(at, &l, 0, "comment, element, property or end_header")))
            return false;
    }
    h->size = (size_t)(p - text);
    h->lines = at.line;
    if (!formatted)
        return fail(at, &l, 0, "the format line first");
    return l.count == 1 || fail(at, &l, 1, "the end of the line");
}

const struct ply_element *ply_find_element(const struct ply_header *h, const char *name) {
    for (int i = 0; i < h->element_count; i++)
        if (strcmp(h->elements[i].name, name) == 0)
            return &h->elements[i];
    return NULL;
}

int ply_find_property(const struct ply_header *h, const struct ply_element *e, const char *name,
                      bool list) {
    for (int i = e->first; i < e->first + e->property_count; i++)
        if (strcmp(h->properties[i].name, name) == 0 &&
            (h->properties[i].count_type != PLY_NONE) == list)
            return i;
    return -1;
}
