// SPDX-License-Identifier: Apache-2.0
// Lights, of the scene and of shapes: who is lit by them, who sees them, what they are called.
#include <string.h>

#include "scene/language.h"
#include "scene/reader.h"

// "visible_to_camera" of a light: false hides the shape that it stands in, or the sky.
static bool read_hidden(struct reader *r, struct xml_node *node, bool *hidden) {
    const char *text = node_take_value(r, node, "visible_to_camera");
    *hidden = text && strcmp(text, "false") == 0;
    if (!text || *hidden || strcmp(text, "true") == 0)
        return true;
    log_error_at(node->at, "visible_to_camera is \"%s\", expected true or false", text);
    return false;
}

// A light is of a shape, which only "area" is, or of the scene.
static bool stands_right(const struct object *light, bool in_shape) {
    const bool of_shape = strcmp(light->type->name, "area") == 0;
    if (of_shape == in_shape)
        return true;
    if (of_shape)
        log_error_at(light->at, "emitter \"area\" stands in no shape");
    else
        log_error_at(light->at, "emitter \"%s\" stands in a shape, expected \"area\", or the emitter "
                     "directly in the scene", light->type->name);
    return false;
}

bool emitter_read(struct reader *r, struct xml_node *node, uint32_t shape) {
    const char *group = node_take_value(r, node, "group");
    const char *include = node_take_value(r, node, "include");
    const char *exclude = node_take_value(r, node, "exclude");
    bool hidden;
    if (!read_hidden(r, node, &hidden))
        return false;
    struct object *o = object_make(r, r->options->registries.lights, node, NULL, NULL);
    if (!o || !stands_right(o, shape != SCENE_NONE))
        return false;
    struct scene_light *light = LIST_ADD(&r->lights, struct scene_light);
    const char *shape_name =
        shape != SCENE_NONE ? LIST_AT(&r->shapes, struct shape, shape).name : "";
    light->object = o;
    light->shape = shape;
    light->group = group;
    light->include = include;
    light->exclude = exclude;
    light->hidden = hidden;
    if (shape != SCENE_NONE)
        LIST_AT(&r->shapes, struct shape, shape).hidden |= hidden;
    light->name = o->id && shape == SCENE_NONE ? o->id
                  : *shape_name               ? shape_name
                  : o->id                     ? o->id
                  : arena_printf(r->arena, "%s.%zu", o->type->name, r->lights.count - 1);
    return true;
}
