// SPDX-License-Identifier: Apache-2.0
// Light sources.
//
// Conventions: wi points from the lit point towards the light, unit. Emission is what arrives:
// radiance in W/(sr m^2) for area and infinite lights; for delta lights the factor that makes
// `emission / pdf` the incident irradiance per unit cosine (intensity / distance^2, irradiance).
// pdf_sa is per solid angle at the lit point, 1 for delta lights.
#pragma once

#include "base/registry.h"
#include "light/light_tree.h"
#include "math/ray.h"
#include "math/transform.h"
#include "math/vec.h"
#include "math/wide.h"
#include "scene/scene.h"
#include "texture/texture.h"

struct light_sample {
    vec3 wi;
    float distance;    // INFINITY for infinite lights
    float pdf_sa;      // > 0
    spectrum emission; // towards the lit point
    bool delta;        // no other technique can find this light
    bool late;         // set by who chooses the light: emission is asked for when nothing is in the way
    vec3 p, p_error;   // point on the light and its rounding error; unused when infinite
    vec3 n;            // normal there, for offsetting; zero: do not offset
};

// Samples of a lit point a lane.
struct light_samples {
    struct wide3 wi, p, p_error, n, emission;
    wide distance, pdf_sa;
};

enum { LIGHT_GROUPS = 64 / WIDE_LANES };

// A point of a light that was found by a ray. Infinite lights use wi only.
struct light_hit {
    vec3 wi;        // direction of the ray that found it, from the lit point towards the light
    float distance;
    vec3 ng;        // geometric normal there, unit (outwards, flip_normals applied)
    struct texture_point at;
};

// What a light needs to know of the world it stands in.
struct light_scene {
    vec3 centre; // of a sphere around all shapes
    float radius; // > 0
    double origin[3]; // the point of the file's world that is the origin now; subtract it
    const struct shape *shape; // the area light's shape; else NULL
};

struct light_type {
    struct entry entry;
    bool infinite; // found by rays that leave the scene
    bool delta;
    // After reading, with texture objects already prepared. false after an error message.
    bool (*prepare)(struct object *self, const struct light_scene *scene, struct arena *arena);
    // false: this light cannot light that point
    bool (*sample)(const void *data, vec3 p, struct vec2 u, struct light_sample *s);
    // sample without emission, for infinite lights whose emission takes long: most of what is
    // sampled may be in shadow. NULL: sample is fast enough.
    bool (*aim)(const void *data, struct vec2 u, struct light_sample *s);
    // sample, or aim where there is one, for the lanes of p, with the same results; the lanes that
    // were lit. NULL, or false from has_wide (NULL: true): one by one.
    wide_mask (*sample_wide)(const void *data, const struct wide3 *p, const wide u[2],
                             struct light_samples *s);
    bool (*has_wide)(const void *data);
    // sample_wide of an infinite light for LIGHT_GROUPS groups of lanes at most, which wait for memory
    // together; p, p_error and n may stay as they are. NULL: one by one.
    void (*sample_groups)(const void *data, int groups, const wide u[][2],
                          struct light_samples s[], wide_mask lit[]);
    // Radiance along the ray that found it (towards -wi). NULL for delta lights.
    spectrum (*emission)(const void *data, const struct light_hit *hit);
    // sample's density of finding this point of the light from p. NULL for delta lights.
    float (*pdf_sa)(const void *data, vec3 p, const struct light_hit *hit);
    // Of infinite lights: radians between texels, or across the smallest feature. NULL: smooth.
    float (*detail)(const void *data);
    // Mean emitted power in W (luminance), an estimate for choosing lights.
    float (*power)(const void *data);
    // Where a part stands and whither it shines, for choosing lights by the place they light. A
    // light of several parts (the triangles of a mesh) can be sampled by part: part_sample and
    // part_pdf_sa are then sample and pdf_sa of one, whose corners and area part_shape tells; that of
    // a hit is hit->at.triangle. NULL parts: one. NULL bounds: it has no place.
    void (*bounds)(const void *data, uint32_t part, struct light_bounds *b);
    uint32_t (*parts)(const void *data);
    void (*part_shape)(const void *data, uint32_t part, struct light_leaf *leaf);
    bool (*part_sample)(const void *data, uint32_t part, const struct light_leaf *leaf, vec3 p,
                        struct vec2 u, struct light_sample *s);
    float (*part_pdf_sa)(float inv_area, const struct light_hit *hit);
    void (*finish)(void *data); // NULL: nothing to do
};

#define X(name) extern const struct light_type light_##name;
#include "light/list.h"
#undef X

extern const struct registry lights;

static inline const struct light_type *light_type_of(const struct object *o) {
    return (const struct light_type *)o->type;
}

// ---- for the lights themselves ----------------------------------------------------------------

// Parameters that all lights take.
#define LIGHT_PARAMS                                                                               \
    {"sampling_weight", PARAM_IGNORED, .unit = "", .help = "lights are chosen by their power"}

// Power of radiance (mean over all directions) that enters a sphere of that radius.
float light_power_infinite(float mean_radiance, float radius);
// A point given in the light's space, in recentred world space.
vec3 light_position(const struct transform *to_world, vec3 local, const struct light_scene *scene);
// Bounds of a light at one point that shines alike in all directions.
struct light_bounds light_bounds_of_point(vec3 p, spectrum intensity);
// Fills s for a delta light at `position` that sends `intensity` towards p. false: at p itself.
bool light_sample_point(vec3 position, vec3 p, spectrum intensity, struct light_sample *s);
// Rotation of infinite lights: unit axes (a mirror and a common scale are fine; the scale is
// dropped, since it does not move anything at infinity). false after an error message.
bool light_rotation(const struct object *self, const struct transform *to_world,
                    struct affine *world, struct affine *local);
