// SPDX-License-Identifier: Apache-2.0
// placed_quadric_hit for a sphere and a ray a lane, operation by operation.
#pragma once

#include "accel/accel.h"
#include "accel/placed_quadric.h"

// Whether few_sphere_hits serves: spheres whose transform is affine.
bool few_sphere_is_one(const struct placed_quadric *q);
// The lanes that meet it between tmin and tmax, and where.
uint32_t few_sphere_hits(const struct placed_quadric *q, const struct accel_rays *r, wide tmax,
                         wide *t);
