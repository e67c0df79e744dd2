// SPDX-License-Identifier: Apache-2.0
// Triangles and rectangles sampled uniformly by the solid angle they subtend.
//
// In double: the formulas are differences of angles, and lights may be small, slanted or near. A
// rectangle's sample takes about four times as long as one by area.
#pragma once

#include "light/area_shape.h"

// Fills what the functions below need, of a light whose kind, corner and edges are known.
void solid_angle_init(struct area_mesh *a);

// Whether the light is near enough for it; a function of p alone, so that sample and pdf agree.
bool solid_angle_pays(const struct area_mesh *a, vec3 p);

float solid_angle_of_rectangle(const struct area_mesh *a, vec3 p);
float solid_angle_of_triangle(const struct area_mesh *a, vec3 p);

// *xy: place in units of the edges. The solid angle, as above; 0: sample by area instead.
float solid_angle_sample_rectangle(const struct area_mesh *a, vec3 p, struct vec2 u,
                                   struct vec2 *xy);
float solid_angle_sample_triangle(const struct area_mesh *a, vec3 p, struct vec2 u,
                                  struct vec2 *xy);
