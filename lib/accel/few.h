// SPDX-License-Identifier: Apache-2.0
// Scenes of a few primitives: a ray a lane against every one of them.
//
// No tree to walk and no lane that waits for another: for some dozen triangles this is three to six
// times as fast as any tree, whichever way the rays run. What a ray hits does not depend on the
// other lanes.
#pragma once

#include "accel/accel.h"
#include "accel/few_facet.h"

struct few;

// NULL when the scene holds too much for it, or instances.
struct few *few_create(const struct scene *scene);
// Of these facets alone. NULL: there are none.
struct few *few_create_of(const struct few_facet *facets, uint32_t count);
void few_destroy(struct few *f);
void few_intersect(const struct few *f, const struct accel_rays *rays, struct accel_hits *hits);
uint32_t few_occluded(const struct few *f, const struct accel_rays *rays); // a bit a lane
