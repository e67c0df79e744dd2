// SPDX-License-Identifier: Apache-2.0
// The light that an environment kept in a basis of lighting is sampled by: directions in proportion to
// the size of the radiance that is kept, whatever its sign, with a share for everywhere else.
#pragma once

#include "sink/lighting.h"

struct relit_light;

// weights: unfolded. radius: of the scene. It lives in the arena.
struct relit_light *relit_light_make(const struct source_basis *b, const float *weights, float radius,
                                     struct arena *arena);

// Its emission is 1 everywhere: who uses it puts the radiance, which may be negative, in its place.
extern const struct light_type relit_light_type;
