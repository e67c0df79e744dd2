// SPDX-License-Identifier: Apache-2.0
// MERL tables of isotropic reflectance (Matusik et al. 2003, A Data-Driven Reflectance Model):
// `.binary` files.
//
// Coordinates are those of Rusinkiewicz 1998: theta_h and theta_d of half vector and difference,
// and phi_d, of which the table holds half a turn, since swapping eye and light adds the other half.
// Node (i, j, k) stands at theta_h = (i / 90)^2 pi/2, theta_d = j pi/180, phi_d = k pi/180.
// File: three int32 (90 90 180), then planes of R, G, B of doubles, phi_d fastest, divided by the
// scales 1/1500, 1.15/1500, 1.66/1500; little-endian.
//
// Cells where any channel is negative, not finite or beyond 1e12 are invalid: they are counted, and
// filled from the outside in: again and again every invalid cell that has valid ones among its six
// neighbours takes their mean. Valid cells stay as they are, with their noise.
#pragma once

#include "base/mem.h"
#include "math/vec.h"

enum { MERL_THETA_H = 90, MERL_THETA_D = 90, MERL_PHI_D = 180,
       MERL_CELLS = MERL_THETA_H * MERL_THETA_D * MERL_PHI_D };

struct merl_table {
    float (*rgb)[3];        // MERL_CELLS, 1/sr, valid everywhere
    size_t invalid;         // cells that were filled,
    size_t invalid_visible; // and those of them that a pair of directions above the surface meets
};

// Everything lives in the arena. NULL after an error message; a warning when cells were filled.
struct merl_table *merl_read(const char *path, struct arena *arena);

// Counts and fills invalid cells of a table made by other means.
void merl_repair(struct merl_table *t);

// Writes values (negative ones mark invalid cells) atomically. false after an error message.
bool merl_write(const char *path, const float (*rgb)[3]);

static inline size_t merl_index(int theta_h, int theta_d, int phi_d) {
    return (size_t)phi_d + MERL_PHI_D * ((size_t)theta_d + MERL_THETA_D * (size_t)theta_h);
}

// Directions at the node of a cell: half vector in the plane of x and z, wi turned by phi_d about it.
void merl_directions(int theta_h, int theta_d, int phi_d, vec3 *wi, vec3 *wo);

// Whether such a pair stands above the surface, so that its cell has to hold a value.
bool merl_is_visible(vec3 wi, vec3 wo);

// Linear between nodes (or the node at or below, as the authors' program has it). wi, wo above the
// surface.
spectrum merl_eval(const struct merl_table *t, bool nearest, vec3 wi, vec3 wo);
