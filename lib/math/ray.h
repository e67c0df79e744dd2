// SPDX-License-Identifier: Apache-2.0
// Rays, and offsets from rounding-error bounds.
#pragma once

#include "math/vec.h"

struct ray {
    vec3 o, d;        // d need not be unit; t counts in lengths of d
    float tmin, tmax; // open interval that is searched
};

// Moves p off its surface to the side of n that w points to, far enough that p's rounding error
// (absolute, per axis) cannot put it on the other side (Pharr, Jakob, Humphreys 2023, 6.8.6).
static inline vec3 offset_point(vec3 p, vec3 error, vec3 n, vec3 w) {
    const float d = fabsf(n[0]) * error[0] + fabsf(n[1]) * error[1] + fabsf(n[2]) * error[2];
    vec3 offset = d * n;
    if (dot(w, n) < 0)
        offset = -offset;
    vec3 q = p + offset;
    for (int i = 0; i < 3; i++) { // round away from p
        if (offset[i] > 0)
            q[i] = nextafterf(q[i], INFINITY);
        else if (offset[i] < 0)
            q[i] = nextafterf(q[i], -INFINITY);
    }
    return q;
}
