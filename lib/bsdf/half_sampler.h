// SPDX-License-Identifier: Apache-2.0
// Sampling of tabulated reflection by conditional distributions: for a list of directions of the
// eye, how f cos_i is spread over the half vector, whose lobe hardly moves with the eye.
//
// The hemisphere of half vectors is divided into rings, equal steps in sqrt(theta_h), and sectors of
// azimuth relative to the eye's; within a cell half vectors are uniform in solid angle. Between
// listed directions the distributions are mixed. A share of all samples is cosine-distributed, so
// that what a coarse table misses keeps its density.
#pragma once

#include "base/mem.h"
#include "math/density2d.h"
#include "math/vec.h"

enum { HALF_RINGS = 40, HALF_SECTORS = 32, HALF_CELLS = HALF_RINGS * HALF_SECTORS };

// f cos_i of eye wo and light wi, both above the surface.
typedef spectrum (*half_value)(const void *table, vec3 wo, vec3 wi);

struct half_sampler {
    int counts[2];          // of azimuths and angles of the eye
    const float *params[2]; // azimuth and angle to the normal, ascending, radians
    float ring[HALF_RINGS + 1]; // sin^2(theta_h / 2) of the edges
    float (*cdf)[HALF_CELLS + 1]; // [azimuth][angle]
    spectrum *albedo;       // of each slice
};

// Tables live in the arena, params stay the caller's.
void half_sampler_init(struct half_sampler *s, const int counts[2], const float *const params[2],
                       half_value value, const void *table, struct arena *arena);

// The directional albedo of that direction of the eye, by the same cells: consistent, not exact.
spectrum half_sampler_integrate(half_value value, const void *table, vec3 wo);

struct slice_mix half_sampler_at(const struct half_sampler *s, vec3 wo);
spectrum half_sampler_albedo(const struct half_sampler *s, const struct slice_mix *mix);
// The direction may lie below the surface. u1 chooses the slice, or the cosine.
vec3 half_sampler_sample(const struct half_sampler *s, const struct slice_mix *mix, vec3 wo,
                         float u1, struct vec2 u2);
// Density per solid angle of wi, above the surface.
float half_sampler_pdf_sa(const struct half_sampler *s, const struct slice_mix *mix, vec3 wo,
                          vec3 wi);
