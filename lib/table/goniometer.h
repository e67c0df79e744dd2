// SPDX-License-Identifier: Apache-2.0
// Goniometer tables: reflection, and perhaps transmission, measured for a list of incident
// directions over all outgoing ones. All formats below become the same regular table.
//
// Incident directions are all pairs of an angle to the normal and an azimuth. Outgoing directions
// form a grid: angles 0 to pi/2 inclusive, azimuths a whole turn, the first at 0. Azimuths count
// from x towards y, of vectors that point away from the surface: the mirror direction of azimuth
// phi is phi + pi. One azimuth of incidence (0) means an isotropic material. Outgoing directions
// below the surface are stored mirrored at it (z negated).
//
// Formats, by extension:
//   .brdf      Cornell goniometer: "theta_i phi_i theta_s phi_s" and samples at listed wavelengths
//   .dat       ALTA text (Belcour et al.): #DIM, #PARAM_IN, then parameters and values
//   .transfer  transfer probabilities, as transfer.c documents
// Scattered samples (.brdf, .dat) are interpolated onto the grid: the nearest six, weighted by
// (1/d - 1/R)^2 (Franke and Little 1980). Samples that are missing, negative or no numbers are
// counted; grid nodes without a sample take the mean of their neighbours', from the outside in.
#pragma once

#include "base/mem.h"
#include "math/vec.h"

struct goniometer_table {
    int theta_count, phi_count; // incident directions
    float *theta, *phi;         // ascending, radians
    int symmetry;               // of the sample: 1 none, 2 about y = 0, 4 about x = 0 too;
                                // phi covers that part of a turn
    int out_thetas, out_phis;
    // 1/sr, [phi][theta][out_theta][out_phi]; [1] below the surface: NULL where nothing is said
    float (*f[2])[3];
    bool retro; // light comes back rather than being mirrored: stored with azimuths turned by pi
    size_t invalid;
};

enum goniometer_lobe { GONIOMETER_AUTO, GONIOMETER_MIRROR, GONIOMETER_RETRO };

// Everything lives in the arena. NULL after an error message. AUTO: decided by which of the mirrored
// and the incident direction the sample is brighter in.
struct goniometer_table *goniometer_read(const char *path, enum goniometer_lobe lobe,
                                         struct arena *arena);

// Writes reflection and transmission as transfer probabilities (.transfer).
bool transfer_write(const char *path, const struct goniometer_table *t);

static inline size_t goniometer_slice(const struct goniometer_table *t) {
    return (size_t)t->out_thetas * (size_t)t->out_phis;
}

// The table at one incident direction, bilinear in the outgoing one (above the surface).
spectrum goniometer_look(const struct goniometer_table *t, int side, size_t incident, vec3 out);
