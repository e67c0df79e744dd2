// SPDX-License-Identifier: Apache-2.0
// One material by itself, for inspection: a file of a measured material, a material of a scene, or a
// model of the registry with parameters.
#pragma once

#include "bsdf/bsdf.h"
#include "scene/scene.h"

struct material_request {
    const char *what;   // FILE of a measured material, SCENE.xml, or the name of a model
    const char *id;     // which material of the scene; NULL: its only one
    const struct scene_define *defines; // a scene's, or a model's parameters
    size_t define_count;
    bool editable;      // bring it into the editable form, if one is near
};

struct material {
    struct scene *scene;
    const struct object *object;
    struct arena arena;
};

// Reads and prepares. false after an error message, with nothing to close.
bool material_open(struct material *m, const struct material_request *request);
void material_close(struct material *m);

// The material at (0.5, 0.5) of the texture plane, in a frame along the axes.
const struct closure *material_at(const struct material *m, vec3 wo, struct closure_stack *stack);
