// SPDX-License-Identifier: Apache-2.0
// XML files as trees of elements with line numbers.
//
// Text between elements means nothing in a scene and is reported; files that carry data in it keep
// it. Entity declarations are refused (so are their expansion bombs), and so are trees that are too
// deep or too large.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/mem.h"

enum { XML_MOST_DEPTH = 64 };
#define XML_MOST_NODES ((size_t)4 << 20)
#define XML_MOST_BYTES ((size_t)256 << 20)

struct xml_attribute {
    const char *name, *value;
};

struct xml_node {
    const char *tag;
    struct xml_attribute *attributes;
    int attribute_count;
    struct xml_node *first, *last, *next; // children, sibling
    struct where at;
    bool old; // from a file of a version before 2
    const char *old_name; // the attribute `name` as such a file has it; NULL: as it is
    const char *text; // XML_TEXT_KEPT: all text directly inside, pieces joined; else NULL
};

enum xml_text {
    XML_TEXT_REPORTED, // warned about once
    XML_TEXT_KEPT,
};

// The root element; nodes and strings come from the arena. *node_count is raised by the number of
// elements and limits them over several files. NULL after an error message.
struct xml_node *xml_parse(const char *data, size_t size, const char *file, enum xml_text text,
                           struct arena *arena, size_t *node_count);

// The first child of that tag, or NULL.
struct xml_node *xml_child(const struct xml_node *node, const char *tag);

// The attribute's value, or NULL.
const char *xml_get(const struct xml_node *node, const char *attribute);
// Sets or adds an attribute; strings are not copied.
void xml_set(struct xml_node *node, const char *attribute, const char *value, struct arena *arena);
void xml_append(struct xml_node *parent, struct xml_node *child);
// A new element without attributes.
struct xml_node *xml_new(const char *tag, struct where at, struct arena *arena);
