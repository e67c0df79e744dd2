// SPDX-License-Identifier: Apache-2.0
// Bases of 1-D curves: boxes over bins, or hats over nodes.
//
// Conventions: a curve is a function of an angle-like quantity gamma in [0, pi/2] (radians). Knots
// are data, not a formula: they ascend from 0 to pi/2. J boxes have J + 1 edges, box j is 1 inside
// [edge j, edge j+1); J hats have J nodes, hat j is 1 at node j and falls to 0 at its neighbours.
// Either basis sums to 1 at every gamma up to the last knot, and to 0 beyond.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/mem.h"

#define CURVE_END 1.57079632679489661923 // pi/2, the last knot

enum basis_kind { BASIS_BOX, BASIS_HAT };

// How knots lie; a hint for the search, which the knots themselves overrule.
enum basis_spacing {
    SPACING_UNIFORM,   // knots at pi/2 t
    SPACING_QUADRATIC, // knots at pi/2 t^2: narrow lobes at 0 with few bins
    SPACING_ANY,
};

enum { BASIS_MOST = 65536 }; // functions

struct basis {
    enum basis_kind kind;
    enum basis_spacing spacing;
    uint32_t count;      // functions, and so coefficients
    const double *knots; // basis_knots(b) of them, owned by the arena
};

static inline uint32_t basis_knots(const struct basis *b) {
    return b->kind == BASIS_BOX ? b->count + 1 : b->count;
}

// Intervals between knots.
static inline uint32_t basis_intervals(const struct basis *b) {
    return basis_knots(b) - 1;
}

// Boxes: count >= 1; hats: count >= 2.
struct basis basis_make(struct arena *arena, enum basis_kind kind, uint32_t count,
                        enum basis_spacing spacing);
bool basis_equal(const struct basis *a, const struct basis *b);

// The interval that holds gamma, in [0, last knot], and the place inside it, in [0, 1].
uint32_t basis_interval(const struct basis *b, double gamma);
double basis_place(const struct basis *b, uint32_t interval, double gamma);

// The functions that are not zero at gamma and their values: 1 for boxes, 2 for hats, 0 beyond the
// last knot (by more than rounding in single precision).
uint32_t basis_at(const struct basis *b, double gamma, uint32_t index[2], double value[2]);

// The sharpest lobe that it carries, the n of cos(g)^n: its spread, 1 / sqrt(n), takes 3.3 bins, so that
// J uniform ones carry (J / 5.2)^2. Sharper ones come out too wide.
double basis_exponent(const struct basis *b);
