// SPDX-License-Identifier: Apache-2.0
// Rays as callers have them, sixteen at a time, for few.h, in pieces of WIDE_LANES.
#pragma once

#include "accel/few.h"

// Lane by lane; those outside `active` are not traced.
void few_packet_rays(const struct ray rays[WIDE_LANES], uint32_t active, struct accel_rays *p);
void few_packet_intersect(const struct few *f, const struct ray rays[ACCEL_PACKET],
                          uint32_t active, struct accel_hit hits[ACCEL_PACKET]);
// Bit i of the result: ray i is blocked.
uint32_t few_packet_occluded(const struct few *f, const struct ray rays[ACCEL_PACKET],
                             uint32_t active);
// Of up to sixteen rays; bit i: ray i is blocked.
uint32_t few_packet_blocked(const struct few *f, const struct ray *rays, uint32_t count);
