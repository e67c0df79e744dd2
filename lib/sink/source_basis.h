// SPDX-License-Identifier: Apache-2.0
// Bases of lighting: what a relighting tensor has a coefficient for.
//
//     lights    a group of lights: the coefficient is their picture
//     pixels    the directions of a cell of a W x H latitude-longitude grid: the coefficient is the
//               picture of an environment of radiance 1 there and 0 elsewhere; or the wavelet
//               transform of those
//     sh        real spherical harmonics up to order N, orthonormal over the sphere, with polar
//               axis +z and Y_1-1, Y_10, Y_11 proportional to y, z, x (Ramamoorthi and Hanrahan
//               2001): the coefficient is the picture of an environment of radiance Y_lm
//
// Directions are those of the world. Cells run as the texels of an environment picture do: row 0 at
// the top (+y), the middle column at +z; cell (column, row) has number row * W + column.
#pragma once

#include "curve/wavelet.h"
#include "math/directions.h"
#include "sink/sink.h"

enum source_basis_kind { SOURCE_LIGHTS, SOURCE_PIXELS, SOURCE_SH };

struct source_basis {
    enum source_basis_kind kind;
    uint32_t count;                 // coefficients
    int width, height;              // SOURCE_PIXELS
    bool transformed;               // by rows and columns, to wavelets
    enum wavelet wavelet;
    int order;                      // SOURCE_SH
    const uint32_t *group_of_light; // SOURCE_LIGHTS: by light
    uint32_t light_count;           // SOURCE_LIGHTS: sources from here on make the fixed picture
    uint32_t environment;           // else: the one light that is taken apart; others are fixed
};

enum { SOURCE_MOST_ORDER = 10, SOURCE_MOST_SH = 121 };
