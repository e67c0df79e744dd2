// SPDX-License-Identifier: Apache-2.0
// An environment in a basis of lighting (sink/source_basis.h): its coefficients, and the environment
// that given coefficients make.
#pragma once

#include "light/light_triangles.h"
#include "sink/source_basis.h"

// weights[coefficient][3] of SOURCE_PIXELS, means of radiance over cells or their wavelets, or of
// SOURCE_SH, integrals of radiance times Y_lm.
void lighting_project(const struct source_basis *b, const struct sky *sky, float *weights);

// Cells are made ready for lookups: wavelets become radiance.
void lighting_unfold(const struct source_basis *b, float *weights);
// The radiance that unfolded coefficients make from a direction; may be negative.
spectrum lighting_radiance(const struct source_basis *b, const float *weights, vec3 w);
