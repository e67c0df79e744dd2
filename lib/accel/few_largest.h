// SPDX-License-Identifier: Apache-2.0
// The few facets of a scene that rays meet most: floors, walls, ceilings.
//
// Lines that cross a scene evenly meet its facets as often as their areas say (Cauchy, Crofton), so a
// facet counts that has a good share of the area of all that are not larger.
#pragma once

#include "accel/few_facet.h"

enum { FEW_LARGEST = 8 };

// Their number, largest first; none of instanced groups, which may be anywhere.
uint32_t few_largest_of(const struct scene *scene, struct few_facet largest[FEW_LARGEST]);
