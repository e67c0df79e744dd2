// SPDX-License-Identifier: Apache-2.0
// A copy of a Mitsuba XML scene with a few elements changed, for what `relume edit` and `relume relight`
// write back. Files that the scene refers to are found where it was.
#pragma once

#include "base/json.h"
#include "base/xml.h"

struct scene_copy {
    const char *scene, *output;
    struct xml_node *root; // to be changed
    struct arena arena;
};

// Reads a scene and gives its parameters the values that a tensor's metadata tell ("defines"). false
// after an error message; scene_copy_finish either way.
bool scene_copy_init(struct scene_copy *c, const char *scene, const char *output,
                     const struct json *meta);
void scene_copy_finish(struct scene_copy *c);

// The element of that tag and id, wherever it is; NULL: none.
struct xml_node *scene_copy_find(struct xml_node *node, const char *tag, const char *id);
// Appends <TAG name= value=/>.
void scene_copy_add(struct scene_copy *c, struct xml_node *node, const char *tag, const char *name,
                    const char *value);
// Writes the copy; an element's `text` stands before it as a comment. false after an error message.
bool scene_copy_write(struct scene_copy *c);
