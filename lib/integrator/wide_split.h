// SPDX-License-Identifier: Apache-2.0
// Shares of a triangle over which an angle bends too much: it is split at the middles of its edges
// until what that leaves wrong is below the tolerance.
#pragma once

#include "integrator/wide_fit.h"
#include "integrator/wide_overlap.h"

// Adds shares, 1 in all, to o->scalar.margin[axis].
void wide_split_add(struct wide_overlap *o, uint32_t axis, const struct wide_nodes *n, uint32_t lane,
                    const wide gamma[OVERLAP_NODES]);
// The same of some parts.
void wide_margin_add(struct wide_overlap *o, uint32_t axis, const struct part_run *r);
