// SPDX-License-Identifier: Apache-2.0
// The same intensity in all directions from one point.
#include "light/light.h"

struct point {
    struct transform to_world;
    vec3 position;
    spectrum intensity;
    // made by prepare
    vec3 p;
};

static const struct param params[] = {
    {"to_world", PARAM_TRANSFORM, offsetof(struct point, to_world), .def = "", .unit = "",
     .help = "light to world"},
    {"position", PARAM_POINT, offsetof(struct point, position), .def = "0,0,0", .unit = "m",
     .help = "where it stands, before to_world"},
    {"intensity", PARAM_EMISSION, offsetof(struct point, intensity), .def = "1", .min = 0,
     .max = 1e30, .unit = "W/sr", .help = "power per solid angle"},
    LIGHT_PARAMS,
    PARAM_END,
};

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    struct point *d = self->data;
    (void)arena;
    d->p = light_position(&d->to_world, d->position, scene);
    return true;
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    const struct point *d = data;
    (void)u;
    return light_sample_point(d->p, p, d->intensity, s);
}

static float power(const void *data) {
    return 4 * PI * spectrum_luminance(((const struct point *)data)->intensity);
}

static void bounds(const void *data, uint32_t part, struct light_bounds *b) {
    const struct point *d = data;
    (void)part;
    *b = light_bounds_of_point(d->p, d->intensity);
}

const struct light_type light_point = {
    .entry = {.name = "point", .help = "point light", .params = params,
              .size = sizeof(struct point)},
    .delta = true,
    .prepare = prepare, .sample = sample, .power = power, .bounds = bounds,
};
