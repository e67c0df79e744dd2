// SPDX-License-Identifier: Apache-2.0
// Where on a textured rectangle the light comes from: a table of the texture's luminance, for
// sampling points in proportion to it.
#pragma once

#include "light/area_shape.h"

struct area_picture {
    int size;                   // of the square table; 0: none is worth having
    struct distribution rows, *columns; // owned
};

// Makes a table where the mesh is a rectangle whose texture varies much.
void area_picture_init(struct area_picture *t, const struct texture_ref *radiance,
                       const struct area_mesh *mesh);
void area_picture_finish(struct area_picture *t);
// Place in units of the edges, and its density there (1: uniform).
struct vec2 area_picture_sample(const struct area_picture *t, struct vec2 u, float *density);
float area_picture_density(const struct area_picture *t, struct vec2 xy);
