// SPDX-License-Identifier: Apache-2.0
#include "base/xml.h"

#include <ctype.h>
#include <expat.h>
#include <limits.h>
#include <string.h>

struct buffer {
    char *data;
    size_t used, capacity;
};

struct parse {
    XML_Parser parser;
    struct arena *arena;
    const char *file;
    struct xml_node *root;
    struct xml_node *open[XML_MOST_DEPTH];
    struct buffer text[XML_MOST_DEPTH]; // of the open elements, when it is kept
    int depth;
    size_t *node_count;
    enum xml_text text_use;
    bool failed, text_reported;
};

static struct where here(const struct parse *p) {
    return (struct where){p->file, (int)XML_GetCurrentLineNumber(p->parser)};
}

static void stop(struct parse *p) {
    p->failed = true;
    XML_StopParser(p->parser, XML_FALSE);
}

struct xml_node *xml_new(const char *tag, struct where at, struct arena *arena) {
    struct xml_node *node = arena_alloc(arena, sizeof *node);
    node->tag = tag;
    node->at = at;
    return node;
}

static void read_attributes(struct xml_node *node, const char **attributes, struct arena *arena) {
    int n = 0;
    while (attributes[2 * n])
        n++;
    node->attributes = arena_alloc(arena, (size_t)n * sizeof *node->attributes);
    node->attribute_count = n;
    for (int i = 0; i < n; i++) {
        node->attributes[i].name = arena_strdup(arena, attributes[2 * i]);
        node->attributes[i].value = arena_strdup(arena, attributes[2 * i + 1]);
    }
}

static void XMLCALL on_start(void *user, const char *tag, const char **attributes) {
    struct parse *p = user;
    if (p->failed)
        return;
    if (p->depth == XML_MOST_DEPTH) {
        log_error_at(here(p), "<%s> is nested more than %d deep", tag, XML_MOST_DEPTH);
        stop(p);
        return;
    }
    if (++*p->node_count > XML_MOST_NODES) {
        log_error_at(here(p), "more than %zu elements", XML_MOST_NODES);
        stop(p);
        return;
    }
    struct xml_node *node = xml_new(arena_strdup(p->arena, tag), here(p), p->arena);
    read_attributes(node, attributes, p->arena);
    if (p->depth > 0)
        xml_append(p->open[p->depth - 1], node);
    else
        p->root = node;
    p->open[p->depth++] = node;
}

static void XMLCALL on_end(void *user, const char *tag) {
    struct parse *p = user;
    (void)tag;
    if (p->failed)
        return;
    struct buffer *b = &p->text[--p->depth];
    if (b->used > 0)
        p->open[p->depth]->text = arena_strdup(p->arena, b->data);
    b->used = 0;
}

static void keep_text(struct buffer *b, const char *text, size_t length) {
    mem_grow(&b->data, &b->capacity, b->used + length + 1, 1);
    memcpy(b->data + b->used, text, length);
    b->used += length;
    b->data[b->used] = '\0';
}

static void XMLCALL on_text(void *user, const char *text, int length) {
    struct parse *p = user;
    if (p->failed || p->depth == 0)
        return;
    if (p->text_use == XML_TEXT_KEPT) {
        keep_text(&p->text[p->depth - 1], text, (size_t)length);
        return;
    }
    for (int i = 0; i < length && !p->text_reported && !p->failed; i++)
        if (!isspace((unsigned char)text[i])) {
            log_warn_at(here(p), "text inside <%s> means nothing", p->open[p->depth - 1]->tag);
            p->text_reported = true;
        }
}

static void XMLCALL on_entity(void *user, const char *name, int is_parameter, const char *value,
                              int value_length, const char *base, const char *system_id,
                              const char *public_id, const char *notation) {
    struct parse *p = user;
    (void)is_parameter, (void)value, (void)value_length, (void)base;
    (void)system_id, (void)public_id, (void)notation;
    if (!p->failed)
        log_error_at(here(p), "declares the entity \"%s\"; entities are not accepted", name);
    stop(p);
}

static bool parse_all(struct parse *p, const char *data, size_t size) {
    const size_t piece = (size_t)1 << 24; // expat counts in int
    size_t done = 0;
    do {
        const size_t n = size - done < piece ? size - done : piece;
        const bool final = done + n == size;
        if (XML_Parse(p->parser, data + done, (int)n, final) != XML_STATUS_OK) {
            if (!p->failed)
                log_error_at(here(p), "is not well-formed XML: %s",
                             XML_ErrorString(XML_GetErrorCode(p->parser)));
            return false;
        }
        done += n;
    } while (done < size);
    return !p->failed;
}

struct xml_node *xml_parse(const char *data, size_t size, const char *file, enum xml_text text,
                           struct arena *arena, size_t *node_count) {
    if (size > XML_MOST_BYTES) {
        log_error("%s: has %zu bytes, more than the %zu that are accepted", file, size,
                  XML_MOST_BYTES);
        return NULL;
    }
    struct parse p = {XML_ParserCreate(NULL), arena, arena_strdup(arena, file),
                      .node_count = node_count, .text_use = text};
    XML_SetUserData(p.parser, &p);
    XML_SetElementHandler(p.parser, on_start, on_end);
    XML_SetCharacterDataHandler(p.parser, on_text);
    XML_SetEntityDeclHandler(p.parser, on_entity);
    const bool ok = parse_all(&p, data, size);
    XML_ParserFree(p.parser);
    for (int i = 0; i < XML_MOST_DEPTH; i++)
        mem_free(p.text[i].data);
    return ok ? p.root : NULL;
}

struct xml_node *xml_child(const struct xml_node *node, const char *tag) {
    for (struct xml_node *c = node->first; c; c = c->next)
        if (strcmp(c->tag, tag) == 0)
            return c;
    return NULL;
}

const char *xml_get(const struct xml_node *node, const char *attribute) {
    for (int i = 0; i < node->attribute_count; i++)
        if (strcmp(node->attributes[i].name, attribute) == 0)
            return node->attributes[i].value;
    return NULL;
}

void xml_set(struct xml_node *node, const char *attribute, const char *value,
             struct arena *arena) {
    for (int i = 0; i < node->attribute_count; i++)
        if (strcmp(node->attributes[i].name, attribute) == 0) {
            node->attributes[i].value = value;
            return;
        }
    const int n = node->attribute_count;
    struct xml_attribute *grown = arena_alloc(arena, ((size_t)n + 1) * sizeof *grown);
    if (n > 0)
        memcpy(grown, node->attributes, (size_t)n * sizeof *grown);
    grown[n] = (struct xml_attribute){attribute, value};
    node->attributes = grown;
    node->attribute_count = n + 1;
}

void xml_append(struct xml_node *parent, struct xml_node *child) {
    child->next = NULL;
    if (parent->last)
        parent->last->next = child;
    else
        parent->first = child;
    parent->last = child;
}
