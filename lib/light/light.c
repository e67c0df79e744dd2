// SPDX-License-Identifier: Apache-2.0
#include "light/light.h"

#include <float.h>

static const struct entry *const entries[] = {
#define X(name) &light_##name.entry,
#include "light/list.h"
#undef X
    NULL,
};

const struct registry lights = {"light", entries};

float light_power_infinite(float mean_radiance, float radius) {
    return minf(4 * PI * PI * radius * radius * mean_radiance, FLT_MAX);
}

vec3 light_position(const struct transform *to_world, vec3 local, const struct light_scene *scene) {
    double p[3] = {local[0], local[1], local[2]};
    transform_point(to_world, p, p);
    return v3((float)(p[0] - scene->origin[0]), (float)(p[1] - scene->origin[1]),
              (float)(p[2] - scene->origin[2]));
}

struct light_bounds light_bounds_of_point(vec3 p, spectrum intensity) {
    return (struct light_bounds){.min = p, .max = p, .axis = v3(0, 0, 1), .cos_o = -1, .cos_e = 0,
                                 .intensity = minf(spectrum_luminance(intensity), FLT_MAX)};
}

bool light_sample_point(vec3 position, vec3 p, spectrum intensity, struct light_sample *s) {
    const vec3 d = position - p;
    const float distance = length(d);
    if (!(distance > 0) || !(distance < INFINITY))
        return false;
    // Divided twice: the square alone may leave the range of float.
    const spectrum irradiance = intensity / distance / distance;
    *s = (struct light_sample){.wi = normalize(d), .distance = distance, .pdf_sa = 1,
                               .emission = spectrum_clamp(irradiance, 0, FLT_MAX), .delta = true,
                               .p = position};
    return !spectrum_is_black(s->emission);
}

bool light_rotation(const struct object *self, const struct transform *to_world,
                    struct affine *world, struct affine *local) {
    const struct affine a = affine_from(to_world);
    *world = (struct affine){normalize(a.x), normalize(a.y), normalize(a.z), v3(0, 0, 0)};
    const float lengths[3] = {length(a.x), length(a.y), length(a.z)};
    const float tolerance = 1e-4f;
    const bool rotation = lengths[0] > 0 && fabsf(lengths[1] / lengths[0] - 1) < tolerance &&
                          fabsf(lengths[2] / lengths[0] - 1) < tolerance &&
                          fabsf(dot(world->x, world->y)) < tolerance &&
                          fabsf(dot(world->y, world->z)) < tolerance &&
                          fabsf(dot(world->z, world->x)) < tolerance;
    if (!rotation) {
        log_error_at(self->at, "%s: to_world changes angles, expected a rotation",
                     self->type->name);
        return false;
    }
    // The inverse of a rotation is its transpose.
    *local = (struct affine){v3(world->x[0], world->y[0], world->z[0]),
                             v3(world->x[1], world->y[1], world->z[1]),
                             v3(world->x[2], world->y[2], world->z[2]), v3(0, 0, 0)};
    return true;
}
