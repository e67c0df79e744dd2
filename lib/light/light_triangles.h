// SPDX-License-Identifier: Apache-2.0
// The sky as triangles of constant radiance (Ben-Artzi 2007, 4.2.3): an octahedron whose triangles
// are split in four, always the one of greatest
//
//     radiance integrated over it * min(solid angle, 0.01 sr)^(1/4)
//
// (the metric of structured importance sampling, Agarwal et al. 2003), until there are enough.
// Unlike points they keep the angles over which light arrives, without which a sharp highlight shows
// every light as a dot.
//
// Conventions: directions towards the light, world space. Triangles stand in the order of the tree,
// so that neighbours in the list are neighbours in the sky. Those without light are left out.
//
// More triangles are made by splitting more, so that a list for few is refined to one for many:
// what is missing (light_triangles_refine) are the children, and the split ones with the light
// taken away.
#pragma once

#include <stdint.h>

#include "math/direction.h"
#include "math/vec.h"

struct light_triangle {
    struct direction corner[3], centre;
    double solid_angle;
    double power[3]; // radiance integrated over it, per channel
    int level;       // splits above it, and its number among the cells of that level: the same
    uint64_t number; // in every list
};

struct light_triangles {
    struct light_triangle *items; // owned
    uint32_t count;
    double power[3]; // sum
};

// Radiance from a direction, all infinite lights together.
struct sky {
    spectrum (*radiance)(const void *ctx, vec3 w);
    const void *ctx;
    double detail; // radians: smallest distance between texels; 0: smooth
};

// At most `most` triangles (at least 8). The integral of the radiance is kept by every split; it is
// measured at points twice as dense as the details, and far more where it matters.
void light_triangles_init(struct light_triangles *t, const struct sky *sky, uint32_t most,
                          int threads);
// Turns a list into what it has more than one for fewer triangles of the same sky.
void light_triangles_refine(struct light_triangles *t, const struct light_triangles *coarse);
void light_triangles_finish(struct light_triangles *t);

// Between the directions of a spherical triangle.
double solid_angle_within(const struct direction corner[3]);
