// SPDX-License-Identifier: Apache-2.0
// Triangles as few.c tests them: two that make a flat convex quadrilateral share one test.
//
// Corners q0 q1 q2 (q3) in order. Edges 0 to 3 of a quadrilateral run from corner to corner, edge 4
// is the diagonal from q0 to q2; a triangle has edges 0 to 2. Each is kept as the Pluecker
// coordinates of its line from a to b: b - a and a x b.
#pragma once

#include "scene/scene.h"

enum { FACET_DIAGONAL = 4 };

struct few_facet {
    float edge[5][3], moment[5][3];
    float normal[3]; // largest component 1
    float corner[3]; // q0
    uint32_t count;  // triangles: 1, or 2
    uint32_t shape, primitive[2]; // q0 q1 q2, and q0 q2 q3
    uint32_t first[2];            // which vertex of the triangle q0 is
};

// Of a triangle, and of the next one where the two make a quadrilateral.
void few_facet_of(const struct mesh *m, uint32_t shape, uint32_t triangle, struct few_facet *f);
// Facets of a mesh, at most one a triangle; their number. Room for all is the caller's.
uint32_t few_facets_of(const struct mesh *m, uint32_t shape, struct few_facet *facets);
