// SPDX-License-Identifier: Apache-2.0
#include "accel/few_sphere.h"

#include "math/wide_double.h"

struct double3 {
    wide_double x, y, z;
};

bool few_sphere_is_one(const struct placed_quadric *q) {
    const double *last = q->to_object.m[3];
    return q->kind == SHAPE_SPHERE && last[0] == 0 && last[1] == 0 && last[2] == 0 && last[3] == 1;
}

static wide_double row_times(const double m[4], struct double3 p) {
    return m[0] * p.x + m[1] * p.y + m[2] * p.z;
}

static struct double3 times(const struct transform *t, struct double3 p) {
    return (struct double3){row_times(t->m[0], p), row_times(t->m[1], p), row_times(t->m[2], p)};
}

static wide_double dot_double(struct double3 a, struct double3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// sphere_roots of scene/quadric.c, and which of them is taken. Rays of half the lanes, in object space.
static wide_long hits_of_half(struct double3 o, struct double3 d, wide_double tmin,
                              wide_double tmax, wide_double *t) {
    const wide_double a = dot_double(d, d), b = dot_double(o, d), s = b / a;
    const struct double3 f = {o.x - s * d.x, o.y - s * d.y, o.z - s * d.z};
    const wide_double discriminant = a * (1 - dot_double(f, f));
    const wide_double c = dot_double(o, o) - 1;
    const wide_double q = -(b + wide_double_copysign(wide_double_sqrt(discriminant), b));
    const wide_double r0 = q / a, r1 = wide_double_select(q != 0, c / q, r0);
    const wide_double near = wide_double_select(r0 < r1, r0, r1);
    const wide_double far = wide_double_select(r0 < r1, r1, r0);
    const wide_long first = (near > tmin) & (near < tmax);
    *t = wide_double_select(first, near, far);
    return (discriminant >= 0) & (first | ((far > tmin) & (far < tmax)));
}

static struct double3 half_of(struct wide3 v, int half) {
    return (struct double3){wide_half_to_double(v.x, half), wide_half_to_double(v.y, half),
                            wide_half_to_double(v.z, half)};
}

uint32_t few_sphere_hits(const struct placed_quadric *q, const struct accel_rays *r, wide tmax,
                         wide *t) {
    wide_double found[WIDE_HALVES];
    uint32_t bits = 0;
    for (int half = 0; half < WIDE_HALVES; half++) {
        struct double3 o = times(&q->to_object, half_of(r->o, half));
        o.x += q->to_object.m[0][3];
        o.y += q->to_object.m[1][3];
        o.z += q->to_object.m[2][3];
        const struct double3 d = times(&q->to_object, half_of(r->d, half));
        bits |= wide_long_bits(hits_of_half(o, d, wide_half_to_double(r->tmin, half),
                                            wide_half_to_double(tmax, half), &found[half]))
                << WIDE_HALF * half;
    }
    *t = wide_from_doubles(found[0], found[1]);
    return bits;
}
