// SPDX-License-Identifier: Apache-2.0
// Pinhole camera, with Mitsuba's parameters and conventions.
#include "sensor/projective.h"

struct perspective {
    struct projective projective;
    struct field_of_view view;
    float offset_x, offset_y;
    // made by prepare
    struct film_plane film; // directions with z = 1 in camera space
    vec3 origin;
};

static const struct param params[] = {
    PROJECTIVE_PARAMS(perspective),
    FIELD_OF_VIEW_PARAMS(perspective),
    {"principal_point_offset_x", PARAM_FLOAT, offsetof(struct perspective, offset_x), .def = "0",
     .unit = "widths", .help = "shift of the film against the optical axis"},
    {"principal_point_offset_y", PARAM_FLOAT, offsetof(struct perspective, offset_y), .def = "0",
     .unit = "heights", .help = "shift of the film against the optical axis"},
    {"focus_distance", PARAM_IGNORED, .unit = "m", .help = "a pinhole is sharp at any distance"},
    PARAM_END,
};

static bool prepare(struct object *self, const struct sensor_scene *scene) {
    struct perspective *p = self->data;
    const double aspect = (double)scene->width / scene->height;
    const double half = field_of_view_half_width(self, &p->view, aspect);
    struct transform m;
    if (!(half > 0) || !projective_prepare(self, &p->projective, scene->centre, &m))
        return false;
    const double offset[2] = {p->offset_x, p->offset_y};
    p->film = film_plane_make(&m, scene->width, scene->height, half, 1, offset, false);
    p->origin = affine_from(&m).o;
    return true;
}

static void ray(const void *data, float x, float y, struct vec2 u, struct ray *out) {
    const struct perspective *p = data;
    (void)u;
    const vec3 v = film_plane_at(&p->film, x, y);
    const float l = length(v);
    *out = (struct ray){p->origin, v * (1 / l), p->projective.near_clip * l,
                        p->projective.far_clip * l};
}

const struct sensor_type sensor_perspective = {
    .entry = {.name = "perspective", .help = "pinhole camera", .params = params,
              .size = sizeof(struct perspective)},
    .prepare = prepare, .ray = ray,
};
