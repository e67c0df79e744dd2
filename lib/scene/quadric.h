// SPDX-License-Identifier: Apache-2.0
// Intersection with the shapes that are not triangles, in their object space (scene.h).
#pragma once

#include "math/transform.h"
#include "scene/scene.h"

// Smallest t in (tmin, tmax) where o + t d meets the shape; double throughout, so that a sphere's
// far side is found as well as its near one. false: none.
bool quadric_intersect(enum shape_kind kind, const double o[3], const double d[3], double tmin,
                       double tmax, double *t);

// Of the object-space point p on the shape: normal (not unit), uv, derivatives.
void quadric_surface(enum shape_kind kind, const double p[3], double n[3], double uv[2],
                     double dpdu[3], double dpdv[3]);

// Moves p, found by a ray, onto the shape itself.
void quadric_project(enum shape_kind kind, double p[3]);

// Object-space bounding box.
void quadric_bounds(enum shape_kind kind, double lo[3], double hi[3]);
