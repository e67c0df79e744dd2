// SPDX-License-Identifier: Apache-2.0
// A picture thrown from one point, the counterpart of a perspective camera: looks along +z, +x to
// the left of the picture, +y up, as Mitsuba's sensors do. The texture is the irradiance over pi on
// the plane z = 1, so that a plane parallel to it is lit without a falloff to its corners.
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "light/light.h"

struct projector {
    struct transform to_world;
    struct texture_ref irradiance;
    float scale, fov;
    int fov_axis;
    const char *focal_length;
    // made by prepare
    vec3 p;
    struct affine to_local, world;
    float half_x, half_y;      // of the picture on the plane z = 1
};

enum axis { AXIS_X, AXIS_Y, AXIS_DIAGONAL, AXIS_SMALLER, AXIS_LARGER };

static const char *const axes[] = {"x", "y", "diagonal", "smaller", "larger", NULL};

static const struct param params[] = {
    {"to_world", PARAM_TRANSFORM, offsetof(struct projector, to_world), .def = "", .unit = "",
     .help = "light to world; shines along +z"},
    {"irradiance", PARAM_TEXTURE_EMISSION, offsetof(struct projector, irradiance), .def = "1",
     .min = 0, .max = 1e30, .unit = "W/m^2", .help = "picture: over pi, on the plane z = 1"},
    {"scale", PARAM_FLOAT, offsetof(struct projector, scale), .def = "1", .min = 0, .max = 1e30,
     .unit = "", .help = "factor of the irradiance"},
    {"fov", PARAM_FLOAT, offsetof(struct projector, fov), .min = 1e-4, .max = 179.9999,
     .unit = "degrees", .help = "angle that the picture fills along fov_axis", .optional = true},
    {"fov_axis", PARAM_CHOICE, offsetof(struct projector, fov_axis), .def = "x", .unit = "",
     .help = "which extent of the picture fov spans", .choices = axes},
    {"focal_length", PARAM_STRING, offsetof(struct projector, focal_length), .unit = "mm",
     .help = "35 mm film equivalent, instead of fov; without both: 50mm", .optional = true},
    LIGHT_PARAMS,
    PARAM_END,
};

// Half the width on the plane z = 1. aspect: width over height.
static double half_width(double half, enum axis axis, double aspect) {
    if (axis == AXIS_SMALLER)
        axis = aspect < 1 ? AXIS_X : AXIS_Y;
    else if (axis == AXIS_LARGER)
        axis = aspect < 1 ? AXIS_Y : AXIS_X;
    if (axis == AXIS_DIAGONAL)
        return half * aspect / sqrt(1 + aspect * aspect);
    return axis == AXIS_Y ? half * aspect : half;
}

static bool choose_width(const struct object *self, struct projector *d, double aspect) {
    if (d->fov > 0 && d->focal_length) {
        log_error_at(self->at, "projector: fov and focal_length are both given, expected one of them");
        return false;
    }
    double half = tan(0.5 * (double)d->fov * (M_PI / 180));
    enum axis axis = (enum axis)d->fov_axis;
    if (!(d->fov > 0)) {
        const char *text = d->focal_length ? d->focal_length : "50mm";
        char *end;
        const double mm = strtod(text, &end);
        if (!(mm > 0 && mm < 1e6) || (*end && strcmp(end, "mm") != 0)) {
            log_error_at(self->at, "projector: focal_length is '%s', expected a length like '50mm'",
                         text);
            return false;
        }
        half = 0.5 * sqrt(36 * 36 + 24 * 24) / mm; // diagonal of the film
        axis = AXIS_DIAGONAL;
    }
    d->half_x = (float)half_width(half, axis, aspect);
    d->half_y = d->half_x / (float)aspect;
    return true;
}

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    struct projector *d = self->data;
    (void)arena;
    struct affine local;
    int width = 1, height = 1;
    if (!light_rotation(self, &d->to_world, &d->world, &local))
        return false;
    // Lengths along the axis enter: a scale of the transform moves the plane z = 1.
    struct transform inverse;
    if (!transform_invert(&d->to_world, &inverse)) {
        log_error_at(self->at, "projector: to_world is singular, expected an invertible transform");
        return false;
    }
    d->to_local = affine_from(&inverse);
    d->p = light_position(&d->to_world, v3(0, 0, 0), scene);
    if (d->irradiance.texture)
        texture_size(d->irradiance.texture, &width, &height);
    return choose_width(self, d, (double)width / height);
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    const struct projector *d = data;
    (void)u;
    const vec3 w = affine_vector(&d->to_local, p - d->p);
    if (!(w[2] > 0))
        return false;
    const float x = w[0] / w[2], y = w[1] / w[2];
    if (!(fabsf(x) <= d->half_x && fabsf(y) <= d->half_y))
        return false;
    const struct texture_point at = {
        .uv = {0.5f - 0.5f * x / d->half_x, 0.5f - 0.5f * y / d->half_y}};
    const spectrum value = texture_eval(&d->irradiance, &at) * (PI * d->scale);
    const vec3 n = normalize(w);
    *s = (struct light_sample){.wi = normalize(d->p - p), .distance = length(d->p - p), .pdf_sa = 1,
                               .emission = spectrum_clamp(value / n[2] / w[2] / w[2], 0, FLT_MAX),
                               .delta = true, .p = d->p};
    return s->distance > 0 && s->distance < INFINITY && !spectrum_is_black(s->emission);
}

// The flux through the plane z = 1.
static float power(const void *data) {
    const struct projector *d = data;
    const float mean = spectrum_luminance(texture_mean(&d->irradiance));
    return minf(4 * d->half_x * d->half_y * PI * d->scale * mean, FLT_MAX);
}

static void bounds(const void *data, uint32_t part, struct light_bounds *b) {
    const struct projector *d = data;
    (void)part;
    const float corner2 = 1 + d->half_x * d->half_x + d->half_y * d->half_y;
    const float unit = length2(d->to_local.x); // of the light's lengths per world length, squared
    const float corner = 1 / sqrtf(corner2);
    const spectrum mean = d->irradiance.texture ? maxf(spectrum_luminance(texture_mean(&d->irradiance)), 1e-3f) * spectrum_grey(1)
                                                : d->irradiance.value;
    // between the intensities of the middle and of the corners, 1 / cos^3
    *b = light_bounds_of_point(d->p, mean * (PI * d->scale / unit / sqrtf(corner)));
    b->axis = d->world.z;
    b->cos_o = maxf(corner - 1e-6f, 0);
    b->cos_e = 0.99f;
}

const struct light_type light_projector = {
    .entry = {.name = "projector", .help = "projects a picture from a point", .params = params,
              .size = sizeof(struct projector)},
    .delta = true,
    .prepare = prepare, .sample = sample, .power = power, .bounds = bounds,
};
