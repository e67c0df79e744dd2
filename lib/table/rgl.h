// SPDX-License-Identifier: Apache-2.0
// Measured materials of the RGL database (Dupuy and Jakob 2018, An Adaptive Parameterization for
// Efficient Material Acquisition and Rendering): `.bsdf` files.
//
// f cos_o = spectra(s) D(u_m) / (4 sigma(u_i)), where s is where the distribution of visible normals
// of u_i maps the half vector u_m back to; u = (sqrt(2 theta / pi), phi / 2 pi + 1/2).
// Conventions: arrays as in the file, the first index first: [phi_i][theta_i][y][x], x along theta.
// Spectral files are brought to linear Rec.709 under D65 when they are read; RGB files hold it.
#pragma once

#include "base/mem.h"
#include "math/vec.h"

struct rgl_table {
    int phi_count, theta_count;
    const float *phi, *theta;           // of the incident directions, ascending, radians
    int ndf_size[2], sigma_size[2], vndf_size[2], size[2]; // height, width of a slice
    const float *ndf, *sigma, *vndf, *luminance;
    const float *rgb;                   // [phi][theta][3][y][x]; may be slightly negative
    bool jacobian, isotropic, spectral;
    int reduction;                      // symmetries of anisotropic data: 1, 2 or 4
    const char *description;
    size_t invalid;                     // values that were no numbers or negative, taken as 0
};

// Everything lives in the arena. NULL after an error message.
struct rgl_table *rgl_read(const char *path, struct arena *arena);
