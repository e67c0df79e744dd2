// SPDX-License-Identifier: Apache-2.0
#include "replay/scene_copy.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

bool scene_copy_init(struct scene_copy *c, const char *scene, const char *output) {
    size_t size, nodes = 0;
    *c = (struct scene_copy){.scene = scene, .output = output};
    char *text = file_read(scene, XML_MOST_BYTES, &size);
    c->root = text ? xml_parse(text, size, scene, XML_TEXT_REPORTED, &c->arena, &nodes) : NULL;
    mem_free(text);
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
    path->next = s->root->first;
    s->root->first = path;
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
