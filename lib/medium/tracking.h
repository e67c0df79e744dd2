// SPDX-License-Identifier: Apache-2.0
// Tracking: flights through a medium to the next scattering event, and transmittance.
//
// Both go collision by collision under a majorant M >= sigma_t that is constant in the cells of a
// coarse grid (Woodcock et al. 1965; Novak et al. 2014, ratio tracking). Absorption is a weight,
// never an end, so that a walk in a medium of albedo 1 has weight 1 exactly.
//
// Coloured media, two ways. GREY: one majorant for all lanes; scattering is chosen with a
// probability that looks at the path's own weights (Kutz et al. 2017, Spectral and Decomposition
// Tracking, history-aware). SPECTRAL: each lane would have tracked with its own majorant; the path
// follows one lane and carries in `ratio` the density with which every lane would have made it,
// relative to that lane; contributions are divided by the mean ratio (Wilkie et al. 2014, Hero
// Wavelength Spectral Sampling; Miller et al. 2019, A Null-Scattering Path Integral Formulation).
#pragma once

#include "math/hash.h"
#include "medium/medium.h"

struct flight {
    spectrum beta;    // throughput; updated
    spectrum ratio;   // densities relative to the lane followed; 1 in GREY; updated
    int lane;         // that is followed; -1: GREY
    spectrum emitted; // radiance gained on the way, weighted; set
    struct rng *rng;
};

// What a contribution of the path is divided by.
static inline float flight_ratio(spectrum ratio) {
    return spectrum_mean(ratio);
}

// Flies from o along unit d, t in (0, end); end may be INFINITY. u in [0, 1) is the first number.
// true: scatters at *t. false: reached the end, or nothing is left (beta black).
bool medium_fly(const struct medium *m, vec3 o, vec3 d, float end, float u, struct flight *f,
                float *t);

// How far a flight through a plain medium is without surfaces: rays need not look farther. It then
// takes medium_scatter where it is not cut short. The same as medium_fly for the same numbers.
float medium_free_path(const struct medium *m, float u, struct rng *rng);
void medium_scatter(const struct medium *m, struct flight *f);

// Transmittance along o + t d, t in (0, end), d of any length: exact where homogeneous, else by
// ratio tracking, unbiased and at most 1.
spectrum medium_transmittance(const struct medium *m, vec3 o, vec3 d, float end, struct rng *rng);

// Optical depth of the same by quadrature voxel by voxel, to rounding; `out` has a value a lane.
void medium_optical_depth(const struct medium *m, vec3 o, vec3 d, float end,
                          double out[SPECTRUM_LANES]);
