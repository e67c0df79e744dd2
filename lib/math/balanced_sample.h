// SPDX-License-Identifier: Apache-2.0
// Some cells of a grid, drawn to tell the total of a quantity that is costly to measure: more often
// where a known quantity says that it is large, and spread over the grid.
//
// Cells are put in an order in which neighbours on the grid are near each other, scrambled at random
// (Morton's order, each bit flipped by the bits above it), and drawn systematically along it, each with
// the probability that it was given: D. Stevens and A. Olsen, "Spatially Balanced Sampling of Natural
// Resources", JASA 99 (2004). What lies together, as errors of a picture do, is neither missed nor
// drawn many times.
#pragma once

#include <stdint.h>

#include "math/hash.h"
#include "math/repeats.h"

struct balanced_sample {
    uint32_t count, cells;
    uint32_t *cell;      // that were drawn, in the order of drawing
    double *probability; // of each of these, > 0; 1: whatever the random numbers are
};

// Draws `wanted` of across * down cells, or all; the order of rows is that of `size`. Probabilities are
// proportional to size (> 0), but for cells that are large enough to be drawn anyway; all are equal
// where sizes are not finite or one is not positive. At most 65536 cells in a row or column.
void balanced_sample_draw(struct balanced_sample *s, uint32_t across, uint32_t down,
                          const double *size, uint32_t wanted, struct rng *rng);
void balanced_sample_finish(struct balanced_sample *s);

// The total over all cells of what was measured in those drawn, without bias, and its 95 % interval.
// variance: of each measurement's own noise, >= 0.
struct measured balanced_sample_total(const struct balanced_sample *s, const double *value,
                                      const double *variance);
