// SPDX-License-Identifier: Apache-2.0
// Quotients times cosine (curve/quotient.h) for a direction a lane, in single precision: to
// 1e-5 of the double ones.
#pragma once

#include "curve/quotient.h"
#include "math/direction.h"
#include "math/wide.h"

enum { FRESNEL_STEPS = 1024 };

// A term's quotient, with its Fresnel factor over even steps of cos theta_d.
struct wide_quotient {
    const struct quotient *quotient;
    bool fits; // false: it is to be evaluated one by one
    float (*fresnel)[FRESNEL_STEPS + 2]; // per channel; NULL: none
};

void wide_quotient_init(struct wide_quotient *w, const struct quotient *q, struct arena *arena);

// wi: unit, local, 0 where it is not above the surface; wo above it. out: per channel.
void wide_quotient_cos(const struct wide_quotient *w, struct direction wo, const struct wide3 *wi,
                       wide out[CURVE_CHANNELS]);
