// SPDX-License-Identifier: Apache-2.0
// Radiance along one ray, with Mitsuba's parameters; every pixel sees the same.
#include "sensor/sensor.h"

struct radiancemeter {
    struct transform to_world;
    vec3 origin, direction;
    // made by prepare
    struct ray ray;
};

static const struct param params[] = {
    {"to_world", PARAM_TRANSFORM, offsetof(struct radiancemeter, to_world), .def = "", .unit = "",
     .help = "looks along +z from the origin, unless direction is given"},
    {"origin", PARAM_POINT, offsetof(struct radiancemeter, origin), .def = "0", .unit = "m",
     .help = "where it stands; goes with direction"},
    {"direction", PARAM_VECTOR, offsetof(struct radiancemeter, direction), .unit = "",
     .help = "in which it looks; of any length", .optional = true},
    PARAM_END,
};

static bool prepare(struct object *self, const struct sensor_scene *scene) {
    struct radiancemeter *r = self->data;
    double o[3] = {0, 0, 0};
    vec3 d = r->direction;
    for (int i = 0; i < 3; i++)
        o[i] = (double)r->origin[i] - scene->centre[i];
    if (length2(r->origin) > 0 && !(length2(d) > 0)) {
        log_error_at(self->at, "radiancemeter: an origin without direction, expected both or to_world");
        return false;
    }
    if (!(length2(d) > 0)) {
        d = affine_from(&r->to_world).z;
        for (int i = 0; i < 3; i++)
            o[i] = r->to_world.m[i][3] - scene->centre[i];
    }
    d = normalize(d);
    if (!(fabsf(length2(d) - 1) < 1e-3f)) {
        log_error_at(self->at, "radiancemeter: the direction has no length");
        return false;
    }
    if (!sensor_reaches(self, o))
        return false;
    r->ray = (struct ray){v3((float)o[0], (float)o[1], (float)o[2]), d, 0, INFINITY};
    return true;
}

static void ray(const void *data, float x, float y, struct vec2 u, struct ray *out) {
    (void)x;
    (void)y;
    (void)u;
    *out = ((const struct radiancemeter *)data)->ray;
}

const struct sensor_type sensor_radiancemeter = {
    .entry = {.name = "radiancemeter", .help = "radiance along one ray, in W/(sr m^2)",
              .params = params, .size = sizeof(struct radiancemeter)},
    .prepare = prepare, .ray = ray, .own_area = true,
};
