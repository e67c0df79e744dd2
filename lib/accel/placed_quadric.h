// SPDX-License-Identifier: Apache-2.0
// A quadric where it stands in the world: what every way of tracing needs of it.
#pragma once

#include "math/transform.h"
#include "scene/scene.h"

struct placed_quadric {
    enum shape_kind kind;
    uint32_t shape;
    struct transform to_world, to_object;
};

// false when the shape's transform is singular.
bool placed_quadric_init(struct placed_quadric *q, const struct scene *scene, uint32_t shape);

// World-space box that holds it.
void placed_quadric_bounds(const struct placed_quadric *q, float lo[3], float hi[3]);

// Smallest t in (tmin, tmax) where o + t d meets it, in double. false: none.
bool placed_quadric_hit(const struct placed_quadric *q, const double o[3], const double d[3],
                        double tmin, double tmax, double *t);
