// SPDX-License-Identifier: Apache-2.0
#include "accel/placed_quadric.h"

#include <math.h>

#include "scene/quadric.h"

bool placed_quadric_init(struct placed_quadric *q, const struct scene *scene, uint32_t shape) {
    const struct shape *s = &scene->shapes[shape];
    q->kind = s->kind;
    q->shape = shape;
    q->to_world = s->to_world;
    return transform_invert(&s->to_world, &q->to_object);
}

void placed_quadric_bounds(const struct placed_quadric *q, float lo[3], float hi[3]) {
    double object[2][3], corner[3], p[3], least[3], most[3];
    quadric_bounds(q->kind, object[0], object[1]);
    for (int c = 0; c < 8; c++) {
        for (int i = 0; i < 3; i++)
            corner[i] = object[c >> i & 1][i];
        transform_point(&q->to_world, corner, p);
        for (int i = 0; i < 3; i++) {
            least[i] = c == 0 || p[i] < least[i] ? p[i] : least[i];
            most[i] = c == 0 || p[i] > most[i] ? p[i] : most[i];
        }
    }
    for (int i = 0; i < 3; i++) { // one ulp outwards, since p was rounded
        lo[i] = nextafterf((float)least[i], -INFINITY);
        hi[i] = nextafterf((float)most[i], INFINITY);
    }
}

bool placed_quadric_hit(const struct placed_quadric *q, const double o[3], const double d[3],
                        double tmin, double tmax, double *t) {
    double object_o[3], object_d[3];
    transform_point(&q->to_object, o, object_o);
    transform_vector(&q->to_object, d, object_d);
    return quadric_intersect(q->kind, object_o, object_d, tmin, tmax, t);
}
