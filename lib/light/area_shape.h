// SPDX-License-Identifier: Apache-2.0
// Sampling the points of a shape as seen from a point: what the area light needs of each shape.
//
// Conventions: normals n point to the emitting side. Samples that face away are refused.
#pragma once

#include "light/light.h"
#include "math/distribution.h"

// Fills everything of s but emission and delta; `at` with the place on the shape (uv, triangle,
// barycentric) only when it is not NULL.

enum polygon_kind { POLYGON_MESH, POLYGON_TRIANGLE, POLYGON_RECTANGLE };

struct area_mesh {
    const struct mesh *mesh;
    enum polygon_kind kind;
    bool flip;           // emits from the back of the winding
    bool mixed;          // the vertex normals of some triangle oppose its winding
    float area, inv_area;
    struct alias_table by_area; // kind POLYGON_MESH
    // POLYGON_TRIANGLE: corner and two edges; POLYGON_RECTANGLE: also orthogonal
    vec3 corner, edge_x, edge_y, n;
    vec3 middle;
    float least_height;  // above the plane, for sampling by solid angle
    double axes[3][3], extent[2]; // POLYGON_RECTANGLE: unit edges and their normal, edge lengths
    uint32_t first[2]; // of the triangles that make the rectangle: index of the right-angled corner
};

bool area_mesh_init(struct area_mesh *a, const struct shape *shape);
void area_mesh_finish(struct area_mesh *a);
bool area_mesh_sample(const struct area_mesh *a, vec3 p, struct vec2 u, struct light_sample *s,
                      struct texture_point *at);
// The same for a lit point a lane, of a rectangle.
wide_mask area_rectangle_sample_wide(const struct area_mesh *a, const struct wide3 *p,
                                     const wide u[2], struct light_samples *s);
float area_mesh_pdf_sa(const struct area_mesh *a, vec3 p, const struct light_hit *hit);
// POLYGON_RECTANGLE: the point at xy in units of the edges (fills p, p_error, n), and back from a
// place on its triangles.
void area_mesh_place_at(const struct area_mesh *a, struct vec2 xy, struct light_sample *s,
                        struct texture_point *at);
struct vec2 area_mesh_xy(const struct area_mesh *a, const struct texture_point *at);

// Single triangles of a POLYGON_MESH, as above; a hit's is hit->at.triangle.
uint32_t area_mesh_parts(const struct area_mesh *a);
void area_mesh_part_shape(const struct area_mesh *a, uint32_t triangle, struct light_leaf *leaf);
bool area_mesh_part_sample(const struct area_mesh *a, uint32_t triangle,
                           const struct light_leaf *leaf, vec3 p, struct vec2 u,
                           struct light_sample *s, struct texture_point *at);
// For radiance 1; the intensity of a triangle without area is 0.
void area_mesh_bounds(const struct area_mesh *a, uint32_t part, struct light_bounds *b);
// Places that sample a triangle's texture, in barycentric coordinates.
void area_mesh_place(const struct area_mesh *a, uint32_t triangle, struct vec2 b,
                     struct texture_point *at);
// Whether a ray in direction wi meets the emitting side.
bool area_mesh_faces(const struct area_mesh *a, const struct light_hit *hit);

struct area_quadric {
    enum shape_kind kind;
    bool flip;
    bool uniform;        // the transform keeps angles: the area element is constant
    bool round;          // a sphere in the world, to the rounding of float
    struct affine to_world, to_object;
    float jacobian;      // world area per object area, where it is constant
    float area;
    vec3 centre;         // of a uniformly scaled sphere, and its radius
    float radius;
};

bool area_quadric_init(struct area_quadric *q, const struct shape *shape);
bool area_quadric_sample(const struct area_quadric *q, vec3 p, struct vec2 u,
                         struct light_sample *s, struct texture_point *at);
// The same for a lit point a lane, of a sphere that is_wide.
bool area_quadric_is_wide(const struct area_quadric *q);
wide_mask area_sphere_sample_wide(const struct area_quadric *q, const struct wide3 *p,
                                  const wide u[2], struct light_samples *s);
float area_quadric_pdf_sa(const struct area_quadric *q, vec3 p, const struct light_hit *hit);

// For radiance 1.
void area_quadric_bounds(const struct area_quadric *q, struct light_bounds *b);

// From a density per area to one per solid angle; 0 where that is not finite.
static inline float area_to_solid_angle(float pdf_area, float distance, float cos_light) {
    const float pdf = pdf_area * distance * distance / cos_light;
    return cos_light > 0 && pdf < INFINITY ? pdf : 0;
}

// Completes s from s->p and s->n. false: s->p faces away from p, or is p.
bool area_finish_sample(vec3 p, float pdf_area, struct light_sample *s);
