// SPDX-License-Identifier: Apache-2.0
// Orthonormal frames. Local directions have n = +z.
#pragma once

#include "math/vec.h"

struct frame {
    vec3 s, t, n; // orthonormal, right-handed
};

// Any frame around a unit normal (Duff et al. 2017, Building an Orthonormal Basis, Revisited).
static inline struct frame frame_from_normal(vec3 n) {
    const float sign = copysignf(1, n[2]);
    const float a = -1 / (sign + n[2]);
    const float b = n[0] * n[1] * a;
    return (struct frame){v3(1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]),
                          v3(b, sign + n[1] * n[1] * a, -n[1]), n};
}

// The frame around n whose s is nearest to the direction given; falls back when they are parallel.
static inline struct frame frame_from_normal_tangent(vec3 n, vec3 tangent) {
    const vec3 s = tangent - n * dot(n, tangent);
    if (!(length2(s) > 1e-12f * length2(tangent)))
        return frame_from_normal(n);
    const vec3 unit = normalize(s);
    return (struct frame){unit, cross(n, unit), n};
}

static inline vec3 to_local(const struct frame *f, vec3 w) {
    return v3(dot(w, f->s), dot(w, f->t), dot(w, f->n));
}

static inline vec3 to_world(const struct frame *f, vec3 w) {
    return w[0] * f->s + w[1] * f->t + w[2] * f->n;
}

// Trigonometry of a local direction.
static inline float cos_theta(vec3 w) {
    return w[2];
}

static inline float cos2_theta(vec3 w) {
    return w[2] * w[2];
}

static inline float sin2_theta(vec3 w) {
    return maxf(1 - w[2] * w[2], 0);
}

static inline float tan2_theta(vec3 w) {
    return sin2_theta(w) / cos2_theta(w);
}

static inline bool same_hemisphere(vec3 a, vec3 b) {
    return a[2] * b[2] > 0;
}
