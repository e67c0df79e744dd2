// SPDX-License-Identifier: Apache-2.0
// A list of points as a sensor: irradiance on little surfaces, or radiance along rays.
//
// Point i owns the 4x4 pixels, one packet, whose corner sensor_point_corner gives. These are sixteen
// replicates: each draws random numbers of its own. Blocks stand apart, so that rounding of film
// points never takes one for another, and so that they are exact in float.
#pragma once

#include "sensor/sensor.h"

struct sensor_point {
    double p[3];
    vec3 d; // unit: the normal, or the direction in which is looked
};

struct sensor_points {
    uint32_t first;    // number of items[0] in the list: random numbers go by it
    const struct sensor_point *items;
    double centre[3];  // as sensor_scene has it
    float radius;      // of the scene, for the rounding of what stands at the points
};

extern const struct sensor_type sensor_points_irradiance, sensor_points_radiance;

enum { SENSOR_POINT_STRIDE = 8, SENSOR_POINTS_ROW = 1 << 15 };

static inline void sensor_point_corner(uint32_t i, int *x, int *y) {
    *x = SENSOR_POINT_STRIDE * (int)(i % SENSOR_POINTS_ROW);
    *y = SENSOR_POINT_STRIDE * (int)(i / SENSOR_POINTS_ROW);
}
