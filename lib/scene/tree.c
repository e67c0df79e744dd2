// SPDX-License-Identifier: Apache-2.0
#include "scene/tree.h"

#include <string.h>

static struct where place(const struct reader *r) {
    if (r->place.file)
        return r->place;
    return (struct where){r->scene->path, 0};
}

struct xml_node *tree_add(struct reader *r, struct xml_node *parent, const char *tag,
                          const char *type, const char *id) {
    struct xml_node *node = xml_new(tag, place(r), r->arena);
    if (type)
        xml_set(node, "type", arena_strdup(r->arena, type), r->arena);
    if (id)
        xml_set(node, "id", id, r->arena);
    if (parent)
        xml_append(parent, node);
    return node;
}

struct xml_node *tree_add_named(struct reader *r, struct xml_node *parent, const char *tag,
                                const char *type, const char *id) {
    struct xml_node *node = tree_add(r, parent, tag, type, id);
    return id_define(r, id, node, node->at) ? node : NULL;
}

void tree_text(struct reader *r, struct xml_node *parent, const char *tag, const char *name,
               const char *value) {
    struct xml_node *node = tree_add(r, parent, tag, NULL, NULL);
    xml_set(node, "name", name, r->arena);
    xml_set(node, "value", value, r->arena);
}

void tree_number(struct reader *r, struct xml_node *parent, const char *name, double value) {
    tree_text(r, parent, "float", name, arena_printf(r->arena, "%.17g", value));
}

void tree_integer(struct reader *r, struct xml_node *parent, const char *name, int64_t value) {
    tree_text(r, parent, "integer", name, arena_printf(r->arena, "%lld", (long long)value));
}

void tree_triple(struct reader *r, struct xml_node *parent, const char *tag, const char *name,
                 const double v[3]) {
    tree_text(r, parent, tag, name,
              arena_printf(r->arena, "%.17g %.17g %.17g", v[0], v[1], v[2]));
}

void tree_ref(struct reader *r, struct xml_node *parent, const char *id) {
    tree_add(r, parent, "ref", NULL, id);
}

void tree_transform(struct reader *r, struct xml_node *parent, const char *name,
                    const struct transform *t) {
    struct xml_node *node = tree_add(r, parent, "transform", NULL, NULL);
    struct xml_node *matrix = tree_add(r, node, "matrix", NULL, NULL);
    const char *text = "";
    for (int i = 0; i < 16; i++)
        text = arena_printf(r->arena, "%s%s%.17g", text, i ? " " : "", t->m[i / 4][i % 4]);
    xml_set(node, "name", name, r->arena);
    xml_set(matrix, "value", text, r->arena);
}

const char *tree_free_id(struct reader *r, const char *wanted, const char *otherwise) {
    const char *id = arena_strdup(r->arena, wanted && *wanted ? wanted : otherwise);
    const char *base = id;
    for (int i = 2; id_find(r, id); i++)
        id = arena_printf(r->arena, "%s.%d", base, i);
    return id;
}

int64_t tree_keep_mesh(struct reader *r, const struct mesh *m) {
    *LIST_ADD(&r->made, struct mesh) = *m;
    return (int64_t)r->made.count - 1;
}
