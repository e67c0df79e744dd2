// SPDX-License-Identifier: Apache-2.0
#include "driver/receiver.h"

#include <string.h>

#include "sensor/sensor.h"

// The shape of the scene itself with this name; SCENE_NONE after an error message.
static uint32_t find_shape(const struct scene *s, const char *option, const char *name) {
    const char *nearest = "";
    int distance = 1 << 20;
    for (uint32_t i = 0; i < s->shape_count; i++) {
        const struct shape *shape = &s->shapes[i];
        if (shape->group != SCENE_NONE || shape->kind != SHAPE_MESH || !*shape->name)
            continue;
        if (strcmp(shape->name, name) == 0)
            return i;
        if (edit_distance(shape->name, name) < distance) {
            distance = edit_distance(shape->name, name);
            nearest = shape->name;
        }
    }
    log_error("--%s %s: %s has no mesh of that name%s%s", option, name, s->path,
              *nearest ? "; the nearest is " : ", and none that has an id", nearest);
    return SCENE_NONE;
}

static void set_size(struct film_settings *f, int width, int height) {
    *f = (struct film_settings){.width = width, .height = height, .crop_x1 = width,
                                .crop_y1 = height};
}

bool receiver_place(const struct receiver *r, const struct scene_options *reading, struct scene *s) {
    const char *name = r->texels ? r->texels : r->vertices;
    if (!name)
        return true;
    if (r->texels && r->vertices) {
        log_error("--texels and --vertices exclude each other");
        return false;
    }
    const uint32_t shape = find_shape(s, r->texels ? "texels" : "vertices", name);
    if (shape == SCENE_NONE)
        return false;
    const struct sensor_type *type = r->texels ? &sensor_texels : &sensor_vertices;
    struct object *o = arena_alloc(&s->arena, sizeof *o);
    *o = (struct object){.type = &type->entry, .at = s->shapes[shape].at,
                         .data = arena_alloc(&s->arena, type->entry.size)};
    s->sensors = arena_alloc(&s->arena, sizeof *s->sensors);
    s->sensors[0] = o;
    s->sensor_count = 1;
    s->sensor_shape = shape;
    s->sensor_medium = s->shapes[shape].exterior;
    const int rows = (int)((s->shapes[shape].mesh.vertex_count + RECEIVER_ROW - 1) / RECEIVER_ROW);
    if (r->vertices)
        set_size(&s->film, RECEIVER_ROW, rows > 0 ? rows : 1);
    else if (reading->width > 0 && reading->height > 0)
        set_size(&s->film, reading->width, reading->height);
    else
        set_size(&s->film, RECEIVER_TEXELS, RECEIVER_TEXELS);
    return true;
}
