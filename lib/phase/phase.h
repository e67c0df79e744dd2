// SPDX-License-Identifier: Apache-2.0
// Phase functions: how a medium scatters, as a density of directions.
//
// Conventions: wi towards the light, wo towards the eye, both unit and pointing away from the point;
// light that goes straight on has wi = -wo, where the cosine of the deflection is 1. A phase
// function here depends on the deflection alone; it is its own density of sampling, so that the
// weight of a sample is exactly 1. Its integral over the sphere is 1 (albedo is the medium's).
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/frame.h"
#include "math/vec.h"
#include "volume/volume.h"

// Cosine of the deflection, held with its distances from straight on and straight back, so that
// narrow peaks of either side keep their digits.
struct deflection {
    float forward;  // 1 - cosine
    float backward; // 1 + cosine
};

struct phase_type {
    struct entry entry;
    // Checks the parameters and builds tables. false after an error message. NULL: nothing to do.
    bool (*prepare)(struct object *self, struct arena *arena);
    float (*pdf_sa)(const void *data, vec3 p, struct deflection c);
    // u1 chooses between parts, u2 the deflection; all in [0, 1).
    struct deflection (*sample)(const void *data, vec3 p, float u1, float u2);
    float (*mean_cosine)(const void *data, vec3 p);
};

#define X(name) extern const struct phase_type phase_##name;
#include "phase/list.h"
#undef X

extern const struct registry phases;

static inline const struct phase_type *phase_type_of(const struct object *o) {
    return (const struct phase_type *)o->type;
}

// Phase function per steradian, which is the density of phase_sample as well.
float phase_pdf_sa(const struct object *phase, vec3 p, vec3 wo, vec3 wi);
// A direction wi by the phase function, with its density.
vec3 phase_sample(const struct object *phase, vec3 p, vec3 wo, float u1, struct vec2 u2,
                  float *pdf_sa);
// The phase function of a medium that names none: isotropic, or Henyey-Greenstein of that mean
// cosine.
const struct object *phase_default(float mean_cosine, struct arena *arena);
