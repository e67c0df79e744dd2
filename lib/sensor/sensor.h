// SPDX-License-Identifier: Apache-2.0
// Sensors: where paths begin.
//
// Film coordinates run over the whole picture (never the crop): x to the right, y downwards, in
// pixels; the picture covers [0,width) x [0,height).
#pragma once

#include "base/registry.h"
#include "math/ray.h"
#include "math/transform.h"

struct sensor_type {
    struct entry entry;
    // Once, after reading; film size in pixels; centre: the point of the file's world that is the
    // origin of world space now. false after an error message.
    bool (*prepare)(struct object *self, int width, int height, const double centre[3]);
    // A unit-direction ray through film point (x, y) and lens point u; the weight is 1.
    void (*ray)(const void *data, float x, float y, struct vec2 u, struct ray *ray);
};

#define X(name) extern const struct sensor_type sensor_##name;
#include "sensor/list.h"
#undef X

extern const struct registry sensors;

static inline const struct sensor_type *sensor_type_of(const struct object *o) {
    return (const struct sensor_type *)o->type;
}
