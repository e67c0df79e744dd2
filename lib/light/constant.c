// SPDX-License-Identifier: Apache-2.0
// The same radiance from every direction.
#include "light/light.h"
#include "math/warp.h"

struct constant {
    spectrum radiance;
    // made by prepare
    float radius; // of the scene
};

static const struct param params[] = {
    {"radiance", PARAM_EMISSION, offsetof(struct constant, radiance), .def = "1", .min = 0,
     .max = 1e30, .unit = "W/(sr m^2)", .help = "radiance from every direction"},
    LIGHT_PARAMS,
    PARAM_END,
};

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    (void)arena;
    ((struct constant *)self->data)->radius = scene->radius;
    return true;
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    (void)p;
    *s = (struct light_sample){.wi = warp_sphere(u), .distance = INFINITY,
                               .pdf_sa = 1 / (4 * PI),
                               .emission = ((const struct constant *)data)->radiance};
    return true;
}

static spectrum emission(const void *data, const struct light_hit *hit) {
    (void)hit;
    return ((const struct constant *)data)->radiance;
}

static float pdf_sa(const void *data, vec3 p, const struct light_hit *hit) {
    (void)data, (void)p, (void)hit;
    return 1 / (4 * PI);
}

static float power(const void *data) {
    const struct constant *c = data;
    return light_power_infinite(spectrum_luminance(c->radiance), c->radius);
}

const struct light_type light_constant = {
    .entry = {.name = "constant", .help = "uniform environment", .params = params,
              .size = sizeof(struct constant)},
    .infinite = true,
    .prepare = prepare, .sample = sample, .emission = emission, .pdf_sa = pdf_sa, .power = power,
};
