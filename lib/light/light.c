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
    return fminf(4 * PI * PI * radius * radius * mean_radiance, FLT_MAX);
}

vec3 light_position(const struct transform *to_world, vec3 local, const struct light_scene *scene) {
    double p[3] = {local[0], local[1], local[2]};
    transform_point(to_world, p, p);
    return v3((float)(p[0] - scene->origin[0]), (float)(p[1] - scene->origin[1]),
              (float)(p[2] - scene->origin[2]));
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
