// SPDX-License-Identifier: Apache-2.0
// What is seen first answers with a basis (symbolic.h): WIDE_LANES points at once, with the bits of
// symbolic.c's closure for one. For objects without textures whose terms are simple enough; the
// others are shaded one by one.
#pragma once

#include "bsdf/bsdf_wide.h"
#include "integrator/symbolic.h"

bool wide_basis_fits(const struct symbolic_object *o);

// wide_points.data: the lane's struct chain, whose basis is a struct symbolic_object that fits.
extern const struct wide_bsdf wide_basis;
