// SPDX-License-Identifier: Apache-2.0
// Shares of a triangle in the functions of curves (curve/overlap.h), all its parts at once: gamma is
// taken to be quadratic over the triangle and linear over each of 16 parts. Where it bends more than
// that, at the poles of angles, the triangle is split as there.
#pragma once

#include "curve/overlap.h"

// As overlap_add.
void wide_overlap_add(struct overlap *o, const struct overlap_triangle *t,
                      double gamma[OVERLAP_AXES][OVERLAP_NODES],
                      const double light[OVERLAP_CHANNELS]);
