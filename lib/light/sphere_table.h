// SPDX-License-Identifier: Apache-2.0
// A picture on the sphere in latitude-longitude form, with bilinear interpolation, and sampling of
// directions in proportion to its luminance.
//
// Conventions: local directions with y up; u runs once around it, 0 at -z and a quarter at +x; v
// runs from 0 at +y to 1 at -y. Texel (x, y) of a width x height picture stands at
// u = (x + 1/2) / width, v = y / (height - 1): the first and last row are the poles (as Mitsuba).
// Density: bilinear between (luminance x weight of the row) at the four texels of a patch. A row's
// weight is its share of the sphere's integral: the sine of its angle, but at the poles about a
// third of the next row's sine, so that no light is out of reach.
#pragma once

#include "light/light.h"
#include "math/cdf_nodes.h"
#include "math/wide.h"

struct sphere_table {
    int width, height;   // height >= 2
    float (*texels)[3];  // (width + 1) x height and one more, last column as the first; owned
    float *row_weight;   // height; owned
    float unit;          // 1 / largest luminance: keeps products in range
    struct cdf_nodes rows;    // of the height - 1 rows of patches
    struct cdf_nodes columns; // of the patches of each row
    double mean;         // luminance over the sphere
    bool black;
};

// Copies width x height RGB pixels. They are finite and not negative.
void sphere_table_init(struct sphere_table *t, const float *rgb, int width, int height);
void sphere_table_finish(struct sphere_table *t);

spectrum sphere_table_eval(const struct sphere_table *t, vec3 w);
float sphere_table_pdf_sa(const struct sphere_table *t, vec3 w);
// false: the picture is black
bool sphere_table_sample(const struct sphere_table *t, struct vec2 u, vec3 *w, float *pdf_sa,
                         spectrum *value);

// sphere_table_sample for a pair of numbers a lane, with the same results, in two steps: the patches of
// some groups of lanes are found, and their texels sent for; then each group is sampled.
struct sphere_patches {
    uint32_t x[WIDE_LANES], y[WIDE_LANES];
};

void sphere_table_find_wide(const struct sphere_table *t, int groups, const wide u[][2],
                            struct sphere_patches found[]);
wide_mask sphere_table_sample_wide(const struct sphere_table *t, const struct sphere_patches *at,
                                   const wide u[2], struct wide3 *w, wide *pdf_sa,
                                   struct wide3 *value);
