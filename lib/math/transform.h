// SPDX-License-Identifier: Apache-2.0
// 4x4 transforms in double, row-major, acting on column vectors: q = M p.
#pragma once

#include "math/vec.h"

struct transform {
    double m[4][4];
};

extern const struct transform transform_identity;

struct transform transform_multiply(const struct transform *a, const struct transform *b); // a b
bool transform_invert(const struct transform *a, struct transform *inverse); // false: singular
double transform_determinant3(const struct transform *a); // of the upper left 3x3

struct transform transform_translate(double x, double y, double z);
struct transform transform_scale(double x, double y, double z);
struct transform transform_rotate(const double axis[3], double degrees);
// Camera to world, looking along +z with y up and x to the LEFT of the image (Mitsuba's). false: the
// points coincide or up is parallel to the view.
bool transform_look_at(const double origin[3], const double target[3], const double up[3],
                       struct transform *out);

void transform_point(const struct transform *a, const double p[3], double q[3]); // with division
void transform_vector(const struct transform *a, const double v[3], double w[3]);
// Normals transform with the inverse transpose: pass the inverse. Not normalised.
void transform_normal(const struct transform *inverse, const double n[3], double m[3]);
bool transform_is_identity(const struct transform *a);
bool transform_is_finite(const struct transform *a);
// Divides by the last element and clears what exporters' rounding leaves in the last row. false: it
// is projective, which would bend lines; no shape and no camera here can do that.
bool transform_make_affine(struct transform *a);

// Single-precision affine copy for the inner loop.
struct affine {
    vec3 x, y, z, o; // columns
};

struct affine affine_from(const struct transform *a);

static inline vec3 affine_point(const struct affine *a, vec3 p) {
    return p[0] * a->x + p[1] * a->y + p[2] * a->z + a->o;
}

static inline vec3 affine_vector(const struct affine *a, vec3 v) {
    return v[0] * a->x + v[1] * a->y + v[2] * a->z;
}

// Given the inverse transform, takes a normal forward: transpose(inverse) n.
static inline vec3 affine_normal(const struct affine *inverse, vec3 n) {
    return v3(dot(inverse->x, n), dot(inverse->y, n), dot(inverse->z, n));
}
