// SPDX-License-Identifier: Apache-2.0
// Rays, and offsets from rounding-error bounds.
#pragma once

#include "math/vec.h"

struct ray {
    vec3 o, d;        // d need not be unit; t counts in lengths of d
    float tmin, tmax; // open interval that is searched
};

static inline vec3 absolute(vec3 a) {
    return v3(fabsf(a[0]), fabsf(a[1]), fabsf(a[2]));
}

static inline float largest(vec3 a) {
    return maxf(fabsf(a[0]), maxf(fabsf(a[1]), fabsf(a[2])));
}

// The same ray with a direction whose largest component is in [1, 2): the factor is a power of two,
// so nothing is rounded.
static inline struct ray ray_ordinary(struct ray r) {
    const float l = largest(r.d);
    if (!(l > 0) || !(l < INFINITY))
        return r;
    const int e = ilogbf(l);
    r.d = v3(ldexpf(r.d[0], -e), ldexpf(r.d[1], -e), ldexpf(r.d[2], -e));
    r.tmin = ldexpf(r.tmin, e);
    r.tmax = ldexpf(r.tmax, e);
    return r;
}

// -1, 0 or 1 in each lane
static inline vec3 sign(vec3 a) {
    return __builtin_convertvector((a < 0) - (a > 0), vec3);
}

// Bound per axis on the distance between a point w0 + w1 + w2 interpolated on a triangle with edges
// e1, e2 (w: weighted vertices) and where a ray traced in single precision meets the triangle. The
// first term bounds the interpolation, gamma(7) of Pharr, Jakob, Humphreys 2023 (6.8); the second
// the ray tracer's own differences of positions, which grow with the triangle and are there even
// where the interpolation is exact (a plane y = 0).
static inline vec3 triangle_error(vec3 w0, vec3 w1, vec3 w2, vec3 e1, vec3 e2) {
    const float u = 0x1p-24f;
    const float extent = 3 * u * maxf(largest(e1), largest(e2));
    return 7 * u / (1 - 7 * u) * (absolute(w0) + absolute(w1) + absolute(w2)) +
           v3(extent, extent, extent);
}

// Moves p off its surface to the side of n that w points to, far enough that p's rounding error
// (absolute, per axis) cannot put it on the other side (Pharr, Jakob, Humphreys 2023, 6.8.6).
static inline vec3 offset_point(vec3 p, vec3 error, vec3 n, vec3 w) {
    const float d = dot(absolute(n), error);
    const vec3 offset = dot(w, n) < 0 ? -d * n : d * n;
    const vec3 q = p + offset;
    // Away from p by one unit in the last place of the larger of the two, at least.
    return q + 0x1p-23f * (absolute(q) + absolute(offset)) * sign(offset);
}
