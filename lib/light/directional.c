// SPDX-License-Identifier: Apache-2.0
// Parallel light from infinitely far away.
#include <float.h>

#include "light/light.h"

struct directional {
    struct transform to_world;
    vec3 direction;
    spectrum irradiance;
    // made by prepare
    vec3 wi;
    float radius; // of the scene
};

static const struct param params[] = {
    {"to_world", PARAM_TRANSFORM, offsetof(struct directional, to_world), .def = "", .unit = "",
     .help = "light to world; shines along +z"},
    {"direction", PARAM_VECTOR, offsetof(struct directional, direction), .unit = "",
     .help = "direction in which the light travels, instead of to_world", .optional = true},
    {"irradiance", PARAM_EMISSION, offsetof(struct directional, irradiance), .def = "1", .min = 0,
     .max = 1e30, .unit = "W/m^2", .help = "on a surface that faces the light"},
    LIGHT_PARAMS,
    PARAM_END,
};

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    struct directional *d = self->data;
    (void)arena;
    const bool given = length2(d->direction) > 0;
    if (given && !transform_is_identity(&d->to_world)) {
        log_error_at(self->at, "directional: direction and to_world are both given, expected one");
        return false;
    }
    const vec3 w = given ? d->direction : affine_from(&d->to_world).z;
    d->wi = -normalize(w);
    d->radius = scene->radius;
    if (length2(d->wi) > 0)
        return true;
    log_error_at(self->at, "directional: the direction is zero, expected a vector with a length");
    return false;
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    const struct directional *d = data;
    (void)p, (void)u;
    *s = (struct light_sample){.wi = d->wi, .distance = INFINITY, .pdf_sa = 1,
                               .emission = d->irradiance, .delta = true};
    return true;
}

static float power(const void *data) {
    const struct directional *d = data;
    return minf(PI * d->radius * d->radius * spectrum_luminance(d->irradiance), FLT_MAX);
}

const struct light_type light_directional = {
    .entry = {.name = "directional", .help = "parallel light", .params = params,
              .size = sizeof(struct directional)},
    .delta = true,
    .prepare = prepare, .sample = sample, .power = power,
};
