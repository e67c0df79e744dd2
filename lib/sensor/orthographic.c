// SPDX-License-Identifier: Apache-2.0
// Parallel projection: the picture's width covers camera x from -1 to 1.
#include "sensor/projective.h"

struct orthographic {
    struct projective projective;
    // made by prepare
    struct film_plane film; // points on the near plane
    vec3 direction;
    float depth;
};

static const struct param params[] = {
    PROJECTIVE_PARAMS(orthographic),
    PARAM_END,
};

static bool prepare(struct object *self, const struct sensor_scene *scene) {
    struct orthographic *o = self->data;
    struct transform m;
    if (!projective_prepare(self, &o->projective, scene->centre, &m))
        return false;
    const double no_offset[2] = {0, 0};
    o->film = film_plane_make(&m, scene->width, scene->height, 1, o->projective.near_clip, no_offset,
                              true);
    const vec3 z = affine_from(&m).z;
    o->direction = normalize(z);
    o->depth = (o->projective.far_clip - o->projective.near_clip) * length(z);
    return true;
}

static void ray(const void *data, float x, float y, struct vec2 u, struct ray *out) {
    const struct orthographic *o = data;
    (void)u;
    *out = (struct ray){film_plane_at(&o->film, x, y), o->direction, 0, o->depth};
}

const struct sensor_type sensor_orthographic = {
    .entry = {.name = "orthographic", .help = "parallel projection", .params = params,
              .size = sizeof(struct orthographic)},
    .prepare = prepare, .ray = ray,
};
