// SPDX-License-Identifier: Apache-2.0
// Freezing (Ben-Artzi 2007, section 6.1.2 and 4.2.4): while one curve, or two of one or two objects, is
// edited, all else is contracted into fewer coefficients.
//
// Of a block's groups, factors that do not depend on these objects are multiplied out; what is left of
// a group is a product of their own factors, a `power`, such as 1, d, d^2, or d e of two objects. Axes of
// other curves are summed up. The coefficients that remain are (power, bins of the axes of those curves):
//
//     F[h][j] = sum over groups g of power h, and bins k  (product of g's frozen factors) c_k T[g][j][k]
//
// No factor is ever divided by, so that an albedo of 0 does no harm.
#pragma once

#include "replay/edit_weights.h"
#include "replay/contraction.h"

enum { FOCUS_MOST = 2 };

struct focus_curve {
    uint32_t object, curve; // curve EDIT_NOTHING: only numbers outside the curves change
};

struct edit_focus {
    struct focus_curve curves[FOCUS_MOST];
    uint32_t curve_count;
    uint32_t power_count;
    struct edited_group *powers; // the factors that are left of a group
    uint32_t *power_of;        // by group
    bool *active;              // by factor: of one of the objects
    struct arena arena;
};

void edit_focus_init(struct edit_focus *f, const struct edit_tensor *e,
                     const struct focus_curve *curves, uint32_t count);
void edit_focus_finish(struct edit_focus *f);

// Whether one of the curves is that, or of that object where numbers outside its curves change.
bool focus_has(const struct focus_curve *curves, uint32_t count, struct focus_curve c);

// Which axes of a block stay: bit i for axis i.
unsigned edit_focus_axes(const struct edit_focus *f, const struct edit_tensor *e, uint32_t block);

// Coefficients that remain of a block: powers times the bins of the axes that stay.
uint32_t edit_focus_coefficients(const struct edit_focus *f, const struct edit_tensor *e,
                                 uint32_t block);

// The map from a block's coefficients to those that remain, with the factors' values as they are.
// Memory from the arena.
struct contraction edit_focus_contraction(const struct edit_focus *f, const struct edit_tensor *e,
                                          uint32_t block, const double (*values)[CURVE_CHANNELS],
                                          struct arena *arena);
