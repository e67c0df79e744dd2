// SPDX-License-Identifier: Apache-2.0
// Directions in double precision: materials whose formulas lose their digits in single precision
// (exponents of 1e7, angles of 89.999 degrees), tables and tests are computed with them.
//
// Conventions: unit length, local frame with n = +z, as in math/frame.h.
#pragma once

#include <math.h>
#include <stdbool.h>

#include "math/vec.h"

struct direction {
    double x, y, z;
};

static inline double direction_dot(struct direction a, struct direction b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Of any vector but zero.
static inline struct direction direction_of(double x, double y, double z) {
    const double inv = 1 / sqrt(x * x + y * y + z * z);
    return (struct direction){x * inv, y * inv, z * inv};
}

static inline struct direction direction_from(vec3 v) {
    return direction_of((double)v[0], (double)v[1], (double)v[2]);
}

static inline vec3 direction_round(struct direction d) {
    return v3((float)d.x, (float)d.y, (float)d.z);
}

// w mirrored at the direction h.
static inline struct direction direction_mirror(struct direction w, struct direction h) {
    const double c = 2 * direction_dot(w, h);
    return (struct direction){c * h.x - w.x, c * h.y - w.y, c * h.z - w.z};
}

// Lower sides to upper ones and back.
static inline struct direction direction_flip(struct direction w) {
    return (struct direction){w.x, w.y, -w.z};
}

// The direction with local coordinates (sin_a cos(phi), sin_a sin(phi), cos_a) around an axis
// (basis: Duff et al. 2017, Building an Orthonormal Basis, Revisited).
static inline struct direction direction_around(struct direction axis, double cos_a, double sin_a,
                                                double phi) {
    const double sign = copysign(1, axis.z), a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
    const double s = sin_a * cos(phi), t = sin_a * sin(phi);
    return (struct direction){
        s * (1 + sign * axis.x * axis.x * a) + t * b + cos_a * axis.x,
        s * sign * b + t * (sign + axis.y * axis.y * a) + cos_a * axis.y,
        -s * sign * axis.x - t * axis.y + cos_a * axis.z};
}
