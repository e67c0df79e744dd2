// SPDX-License-Identifier: Apache-2.0
// Sensors: where paths begin.
//
// Film coordinates run over the whole picture (never the crop): x to the right, y downwards, in
// pixels; the picture covers [0,width) x [0,height).
//
// Cameras see radiance along rays. Meters of irradiance receive on a surface: paths begin at it as at
// a white Lambertian one (integrator.h), so that lights are looked for there too.
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/ray.h"
#include "math/transform.h"
#include "scene/scene.h"

// What a sensor is made ready for.
struct sensor_scene {
    int width, height;         // of the whole picture, in pixels
    double centre[3];          // the point of the file's world that is the origin of world space now
    const struct shape *shape; // it stands in, or NULL
    struct arena *arena;
};

// A point of a surface that receives.
struct sensor_place {
    vec3 p, p_error, n; // world space; absolute error bound per axis; unit, to the side that counts
    float weight;       // mean 1 over the picture
};

struct sensor_type {
    struct entry entry;
    // Once, after reading. false after an error message.
    bool (*prepare)(struct object *self, const struct sensor_scene *scene);
    // A unit-direction ray through film point (x, y) and lens point u; the weight is 1.
    void (*ray)(const void *data, float x, float y, struct vec2 u, struct ray *ray);
    // Of a meter of irradiance, in place of `ray`: the point that film point (x, y) stands for.
    void (*place)(const void *data, float x, float y, struct sensor_place *place);
    bool lens;     // rays depend on the lens point
    bool own_area; // what a pixel means does not reach beyond it: the filter is a box
};

#define X(name) extern const struct sensor_type sensor_##name;
#include "sensor/list.h"
#undef X

extern const struct registry sensors;

static inline const struct sensor_type *sensor_type_of(const struct object *o) {
    return (const struct sensor_type *)o->type;
}

// Whether the shapes of the scene can be met from there, in world space. false after an error message.
bool sensor_reaches(const struct object *self, const double origin[3]);
