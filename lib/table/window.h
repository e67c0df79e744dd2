// SPDX-License-Identifier: Apache-2.0
// Window materials: XML files of LBNL WINDOW and Radiance's genBSDF, as Klems matrices (Klems 1994)
// or tensor trees of rank 3 (isotropic) and 4 (Ward et al. 2012, A Practical Framework for Sharing
// and Rendering Real-World BSDFs).
//
// Values are f in 1/sr, constant in each patch. Front is the side of the normal, the room's; WINDOW
// calls it back (its normals point outdoors), and the names in the files mean WINDOW's.
// All functions take directions mirrored to the upper hemisphere, pointing away from the surface.
// Only the data of the visible range are used.
#pragma once

#include "base/mem.h"
#include "math/vec.h"

enum window_side { WINDOW_FRONT_REFLECTION, WINDOW_BACK_REFLECTION, WINDOW_FRONT_TRANSMISSION,
                   WINDOW_BACK_TRANSMISSION, WINDOW_PARTS };

enum { WINDOW_MOST_RINGS = 64, WINDOW_MOST_CELLS = 4096 };

// A hemisphere cut into patches: rings of equal steps in azimuth, the first of each centred at 0;
// or, when side > 0, side x side squares of the concentric map.
struct window_cells {
    int side;
    int rings, count;
    double theta[WINDOW_MOST_RINGS + 1]; // degrees, 0 to 90
    int sectors[WINDOW_MOST_RINGS];
};

struct window_node {
    int32_t children; // index of the first of 2^rank, or -1: a grid of values
    int32_t log2;     // of the grid's width
    uint32_t values;
};

struct window_part {
    int rank;                    // 0: nothing given; 2: matrix; 3, 4: tensor tree
    struct window_cells in, out; // matrix: its patches; tree: squares as fine as the tree, up to 32
    const float *values;         // matrix: [out][in]
    const struct window_node *nodes; // tree; the root is the first
};

struct window_table {
    struct window_part parts[WINDOW_PARTS];
    size_t invalid; // values that were negative or no numbers, taken as 0
};

// Everything lives in the arena. NULL after an error message.
struct window_table *window_read(const char *path, struct arena *arena);

float window_look(const struct window_part *p, vec3 in, vec3 out);

int window_cell_of(const struct window_cells *c, vec3 w);
// A direction of the cell, uniform in projected solid angle.
vec3 window_cell_sample(const struct window_cells *c, int cell, struct vec2 u);
double window_cell_psa(const struct window_cells *c, int cell); // projected solid angle
