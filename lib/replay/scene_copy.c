// SPDX-License-Identifier: Apache-2.0
#include "replay/scene_copy.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"

// Only Mitsuba's XML is written.
static bool is_xml(const struct scene_copy *c) {
    const char *point = strrchr(c->scene, '.');
    if (point && strcasecmp(point, ".xml") == 0)
        return true;
    log_error("%s: --save-scene changes Mitsuba XML scenes, and this is none", c->scene);
    return false;
}

// The scene itself is never written over: the tensor could not be checked against it any more.
static bool is_another(const struct scene_copy *c) {
    char *from = realpath(c->scene, NULL), *to = realpath(c->output, NULL);
    const bool same = from && to && strcmp(from, to) == 0;
    free(from);
    free(to);
    if (same)
        log_error("%s: is the tensor's own scene; expected another name for --save-scene", c->output);
    return !same;
}

static void put_first(struct xml_node *root, struct xml_node *node) {
    node->next = root->first;
    root->first = node;
    if (!root->last)
        root->last = node;
}

// What comes first gives a parameter its value, whatever the file says below.
static void define(struct scene_copy *c, const struct json *defines) {
    for (size_t i = 0; i < json_count(defines); i++) {
        const char *name = json_key(defines, i), *value = json_text(json_get(defines, name));
        struct xml_node *node = xml_new("default", c->root->at, &c->arena);
        xml_set(node, "name", arena_strdup(&c->arena, name), &c->arena);
        xml_set(node, "value", arena_strdup(&c->arena, value ? value : ""), &c->arena);
        put_first(c->root, node);
    }
}

bool scene_copy_init(struct scene_copy *c, const char *scene, const char *output,
                     const struct json *meta) {
    size_t size, nodes = 0;
    *c = (struct scene_copy){.scene = scene, .output = output};
    if (!is_xml(c) || !is_another(c))
        return false;
    char *text = file_read(scene, XML_MOST_BYTES, &size);
    c->root = text ? xml_parse(text, size, scene, XML_TEXT_REPORTED, &c->arena, &nodes) : NULL;
    mem_free(text);
    if (c->root)
        define(c, json_get(meta, "defines"));
    return c->root != NULL;
}

void scene_copy_finish(struct scene_copy *c) {
    arena_finish(&c->arena);
}

static bool is(const char *text, const char *other) {
    return text && strcmp(text, other) == 0;
}

struct xml_node *scene_copy_find(struct xml_node *node, const char *tag, const char *id) {
    for (struct xml_node *n = node->first; n; n = n->next) {
        if (is(n->tag, tag) && is(xml_get(n, "id"), id))
            return n;
        struct xml_node *inside = scene_copy_find(n, tag, id);
        if (inside)
            return inside;
    }
    return NULL;
}

void scene_copy_add(struct scene_copy *c, struct xml_node *node, const char *tag, const char *name,
                    const char *value) {
    struct xml_node *child = xml_new(tag, node->at, &c->arena);
    xml_set(child, "name", name, &c->arena);
    xml_set(child, "value", value, &c->arena);
    xml_append(node, child);
}

// ---- writing ------------------------------------------------------------------------------------

static void write_text(FILE *f, const char *text) {
    for (; *text; text++)
        switch (*text) {
        case '&': fputs("&amp;", f); break;
        case '<': fputs("&lt;", f); break;
        case '>': fputs("&gt;", f); break;
        case '"': fputs("&quot;", f); break;
        default: fputc(*text, f);
        }
}

static void write_node(FILE *f, const struct xml_node *node, int indent) {
    if (node->text)
        fprintf(f, "%*s<!--%s-->\n", indent, "", node->text);
    fprintf(f, "%*s<%s", indent, "", node->tag);
    for (int i = 0; i < node->attribute_count; i++) {
        fprintf(f, " %s=\"", node->attributes[i].name);
        write_text(f, node->attributes[i].value);
        fputc('"', f);
    }
    fputs(node->first ? ">\n" : "/>\n", f);
    for (const struct xml_node *n = node->first; n; n = n->next)
        write_node(f, n, indent + 4);
    if (node->first)
        fprintf(f, "%*s</%s>\n", indent, "", node->tag);
}

// The folder where the scene's files are looked for, in front of all else.
static bool add_folder(struct scene_copy *s) {
    char folder[4096];
    file_directory(s->scene, folder, sizeof folder);
    char *whole = realpath(folder, NULL);
    if (!whole) {
        log_error("%s: its folder cannot be found", s->scene);
        return false;
    }
    struct xml_node *path = xml_new("path", s->root->at, &s->arena);
    xml_set(path, "value", arena_strdup(&s->arena, whole), &s->arena);
    put_first(s->root, path);
    free(whole);
    return true;
}

static bool write_text_of(struct scene_copy *s) {
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    if (!f) {
        log_error("%s: no memory to write a scene", s->output);
        return false;
    }
    write_node(f, s->root, 0);
    const bool good = fclose(f) == 0 && file_write(s->output, text, size);
    free(text);
    return good;
}

bool scene_copy_write(struct scene_copy *c) {
    return add_folder(c) && write_text_of(c);
}
