// SPDX-License-Identifier: Apache-2.0
// A point light that shines along its +z axis: full within the beam, then falling linearly in the
// angle to nothing at the cutoff, as Mitsuba has it; a texture may be projected through the cone.
#include "light/light.h"

struct spot {
    struct transform to_world;
    spectrum intensity;
    float cutoff_angle, beam_width;
    struct texture_ref texture;
    // made by prepare
    vec3 p;
    struct affine to_local;
    float cutoff, beam; // radians
    float cos_cutoff, cos_beam, tan_cutoff;
};

static const struct param params[] = {
    {"to_world", PARAM_TRANSFORM, offsetof(struct spot, to_world), .def = "", .unit = "",
     .help = "light to world; shines along +z"},
    {"intensity", PARAM_EMISSION, offsetof(struct spot, intensity), .def = "1", .min = 0,
     .max = 1e30, .unit = "W/sr", .help = "intensity inside the beam"},
    {"cutoff_angle", PARAM_FLOAT, offsetof(struct spot, cutoff_angle), .def = "20", .min = 1e-3,
     .max = 180, .unit = "degrees", .help = "half angle beyond which it is dark"},
    {"beam_width", PARAM_FLOAT, offsetof(struct spot, beam_width), .def = "-1", .min = -1,
     .max = 180, .unit = "degrees",
     .help = "half angle of full intensity; -1: three quarters of cutoff_angle"},
    {"texture", PARAM_TEXTURE, offsetof(struct spot, texture), .def = "1", .unit = "",
     .help = "factor of the intensity over the cone"},
    LIGHT_PARAMS,
    PARAM_END,
};

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    struct spot *d = self->data;
    struct transform inverse;
    (void)arena;
    if (!transform_invert(&d->to_world, &inverse)) {
        log_error_at(self->at, "spot: to_world is singular, expected an invertible transform");
        return false;
    }
    const float beam = d->beam_width < 0 ? 0.75f * d->cutoff_angle : d->beam_width;
    if (beam > d->cutoff_angle) {
        log_error_at(self->at, "spot: beam_width %g, expected at most cutoff_angle %g",
                     (double)beam, (double)d->cutoff_angle);
        return false;
    }
    d->p = light_position(&d->to_world, v3(0, 0, 0), scene);
    d->to_local = affine_from(&inverse);
    d->cutoff = d->cutoff_angle * (PI / 180);
    d->beam = beam * (PI / 180);
    d->cos_cutoff = cosf(d->cutoff);
    d->cos_beam = cosf(d->beam);
    d->tan_cutoff = tanf(d->cutoff);
    return true;
}

// Share of the intensity that leaves in the local unit direction.
static float falloff(const struct spot *d, vec3 w) {
    if (w[2] >= d->cos_beam)
        return 1;
    if (w[2] <= d->cos_cutoff)
        return 0;
    return clampf((d->cutoff - acosf(clampf(w[2], -1, 1))) / (d->cutoff - d->beam), 0, 1);
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    const struct spot *d = data;
    (void)u;
    const vec3 w = normalize(affine_vector(&d->to_local, p - d->p));
    const float share = falloff(d, w);
    if (!(share > 0))
        return false;
    spectrum intensity = d->intensity * share;
    if (d->texture.texture) {
        const float scale = 0.5f / (w[2] * d->tan_cutoff);
        const struct texture_point at = {.uv = {0.5f + w[0] * scale, 0.5f + w[1] * scale}};
        intensity *= texture_eval(&d->texture, &at);
    } else {
        intensity *= d->texture.value;
    }
    return light_sample_point(d->p, p, intensity, s);
}

// Integral of the falloff over directions, closed: full cone plus the linear ramp between a and b,
// 2 pi [cos a - (sin b - sin a) / (b - a)].
static float power(const void *data) {
    const struct spot *d = data;
    const float a = d->beam, b = d->cutoff;
    const float mean_cos = b > a ? (sinf(b) - sinf(a)) / (b - a) : cosf(a);
    return TWO_PI * (1 - mean_cos) *
           spectrum_luminance(d->intensity * texture_mean(&d->texture));
}

static bool keeps_angles(const struct affine *m) {
    const float l = length2(m->x), tolerance = 1e-5f;
    return fabsf(length2(m->y) - l) <= tolerance * l && fabsf(length2(m->z) - l) <= tolerance * l &&
           fabsf(dot(m->x, m->y)) <= tolerance * l && fabsf(dot(m->y, m->z)) <= tolerance * l &&
           fabsf(dot(m->z, m->x)) <= tolerance * l;
}

static void bounds(const void *data, uint32_t part, struct light_bounds *b) {
    const struct spot *d = data;
    const struct affine world = affine_from(&d->to_world);
    (void)part;
    *b = light_bounds_of_point(d->p, d->intensity * texture_mean(&d->texture));
    if (!keeps_angles(&world))
        return; // a skewed cone: all directions
    b->axis = normalize(world.z);
    b->cos_o = d->cos_cutoff;
    b->cos_e = 0.99f; // nothing beyond, but for rounding
}

const struct light_type light_spot = {
    .entry = {.name = "spot", .help = "spot light with a linear falloff", .params = params,
              .size = sizeof(struct spot)},
    .delta = true,
    .prepare = prepare, .sample = sample, .power = power, .bounds = bounds,
};
