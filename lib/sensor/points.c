// SPDX-License-Identifier: Apache-2.0
#include "sensor/points.h"

static const struct sensor_point *find(const struct sensor_points *s, float x, float y) {
    const uint32_t column = (uint32_t)x / SENSOR_POINT_STRIDE, row = (uint32_t)y / SENSOR_POINT_STRIDE;
    return &s->items[row * SENSOR_POINTS_ROW + column - s->first];
}

static vec3 position(const struct sensor_points *s, const struct sensor_point *at) {
    return v3((float)(at->p[0] - s->centre[0]), (float)(at->p[1] - s->centre[1]),
              (float)(at->p[2] - s->centre[2]));
}

static void ray(const void *data, float x, float y, struct vec2 u, struct ray *out) {
    const struct sensor_points *s = data;
    const struct sensor_point *at = find(s, x, y);
    (void)u;
    *out = (struct ray){position(s, at), at->d, 0, INFINITY};
}

static void place(const void *data, float x, float y, struct sensor_place *out) {
    const struct sensor_points *s = data;
    const struct sensor_point *at = find(s, x, y);
    const float slack = 4 * 0x1p-24f;
    const vec3 p = position(s, at);
    // The point is often one of a surface, which is rounded too.
    *out = (struct sensor_place){p, slack * (absolute(p) + v3(s->radius, s->radius, s->radius)),
                                 at->d, 1};
}

const struct sensor_type sensor_points_irradiance = {
    .entry = {.name = "points", .help = "irradiance at a list of points"}, .place = place,
    .own_area = true,
};

const struct sensor_type sensor_points_radiance = {
    .entry = {.name = "points", .help = "radiance along a list of rays"}, .ray = ray,
    .own_area = true,
};
