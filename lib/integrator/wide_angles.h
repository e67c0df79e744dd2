// SPDX-License-Identifier: Apache-2.0
// The angles of curves (curve/angles.h, signed as in curve/overlap.h) for WIDE_LANES directions at
// once, in single precision: to 1e-6 radians of the double ones.
#pragma once

#include "curve/angles.h"
#include "math/direction.h"
#include "math/wide.h"

// wi: unit, local; wo above the surface.
wide wide_gamma(const struct gamma *g, struct direction wo, const struct wide3 *wi);
