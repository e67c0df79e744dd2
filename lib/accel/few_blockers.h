// SPDX-License-Identifier: Apache-2.0
// The few facets of a scene that block most shadow rays: ceilings, floors, walls towards the lights.
//
// Which these are only rays can tell: in a hall the largest facets may be those of its outside.
#pragma once

#include "accel/accel.h"
#include "accel/few_facet.h"

enum { FEW_BLOCKERS = 8 };

// Of rays like those to come, the facets that block most, and then most of the rest; their number.
// None of instanced groups, which may be anywhere.
uint32_t few_blockers_of(const struct accel *a, const struct scene *scene, const struct ray *rays,
                         uint32_t count, struct few_facet blockers[FEW_BLOCKERS]);
