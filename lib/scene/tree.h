// SPDX-License-Identifier: Apache-2.0
// Building a tree of the scene language in memory: how readers of other formats say what they have
// found, so that one reader makes objects of it.
#pragma once

#include "scene/reader.h"

// <tag type="TYPE" id="ID">; type and id may be NULL. Appended to parent, unless that is NULL.
struct xml_node *tree_add(struct reader *r, struct xml_node *parent, const char *tag,
                          const char *type, const char *id);
// An object that has an id, which references can then name. NULL after an error message.
struct xml_node *tree_add_named(struct reader *r, struct xml_node *parent, const char *tag,
                                const char *type, const char *id);
// <tag name="NAME" value="...">
void tree_text(struct reader *r, struct xml_node *parent, const char *tag, const char *name,
               const char *value);
void tree_number(struct reader *r, struct xml_node *parent, const char *name, double value);
void tree_integer(struct reader *r, struct xml_node *parent, const char *name, int64_t value);
// <rgb>, <point>, <vector>
void tree_triple(struct reader *r, struct xml_node *parent, const char *tag, const char *name,
                 const double v[3]);
void tree_ref(struct reader *r, struct xml_node *parent, const char *id);
// <transform name="NAME"> with one matrix
void tree_transform(struct reader *r, struct xml_node *parent, const char *name,
                    const struct transform *t);
// An id that no element has yet, near the wanted one ("" and NULL: `otherwise`).
const char *tree_free_id(struct reader *r, const char *wanted, const char *otherwise);
// Hands a mesh to the reader: <shape type="made"> with the integer shape_index takes it.
int64_t tree_keep_mesh(struct reader *r, const struct mesh *m);

// ---- view_of.c: what a model without camera or light is looked at with -----------------------

// A sensor that sees the whole box from the front (+z), a little from the right and above.
void tree_add_view(struct reader *r, struct xml_node *scene, const double lo[3],
                   const double hi[3]);
void tree_add_film(struct reader *r, struct xml_node *sensor);
// A sky with the sun behind the viewer's left shoulder, and grey surroundings.
void tree_add_sky(struct reader *r, struct xml_node *scene);
