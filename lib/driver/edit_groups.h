// SPDX-License-Identifier: Apache-2.0
// Groups: the products of factors that paths collect at their later hops (transport/tensor.h), and how
// a path steps from one to the next.
//
// A factor is the equivalent albedo of an object or of a class of them; or that of a single term; or,
// where the second hop has curves of its own, a coefficient of such a curve. Order does not matter, so
// groups are multisets: for M steps (factors of the first two kinds) and N bounces C(N - 1 + M, M) of
// them (Ben-Artzi 2007, section 5.2), and with W coarse coefficients 1 + W C(N - 2 + M, M).
#pragma once

#include "base/json.h"
#include "driver/edit_classes.h"

enum { EDIT_MOST_BOUNCES = 16, EDIT_MOST_GROUPS = 1 << 20 };

#define EDIT_ALBEDO UINT32_MAX

struct edit_factor {
    uint32_t object; // or class
    uint32_t term, bin; // of a coarse curve, or one that is all of the term; EDIT_ALBEDO: of a class
};

struct edit_groups {
    uint32_t objects, steps, bounces;
    uint32_t coarse; // most bins of a curve at the second hop; 1: it has albedos
    uint32_t factor_count, count;
    struct edit_factor *factors;  // the steps first
    uint32_t *step;               // by object: its first step; each term's follow where they are split
    uint32_t *parent, *last;      // by group: the group without its last factor, and that factor
    uint32_t *next;               // [group][step]: with that factor; UINT32_MAX: too long
    uint32_t **second;            // by object and place: the group of its coarse factor; or NULLs
};

// Number of groups, or UINT64_MAX where they are beyond counting. coarse: coefficients in all of the
// second hop, or 0.
uint64_t edit_groups_count(uint32_t steps, uint32_t bounces, uint64_t coarse);

// classes: NULL: every object is alone. split: by object: whether its terms have factors of their own,
// where it is alone; NULL: none. series: coefficients of a curve at the eye's hop, the second, ...
// (`bounces` of them). false after an error message: a series that is not supported, or too many groups.
bool edit_groups_init(struct edit_groups *g, const struct edit_plan *plan,
                      const struct edit_classes *classes, const bool *split, const uint32_t *series,
                      uint32_t bounces);
void edit_groups_finish(struct edit_groups *g);

// The factors of a group, ascending but for a coarse one, which comes first; returns their number.
uint32_t edit_group_factors(const struct edit_groups *g, uint32_t group,
                            uint32_t factors[EDIT_MOST_BOUNCES]);

// The coarse bins that a term's curve has at the second hop: their number (at most g->coarse), borders, one
// more, and the axis they lie on.
uint32_t edit_groups_coarse(const struct edit_groups *g, const struct form *f, uint32_t term,
                            enum form_slot_name *slot, double *knots);

// Adds "factors" and "groups" to the metadata.
void edit_groups_describe(const struct edit_groups *g, const struct edit_plan *plan,
                          const struct edit_classes *classes, struct json *meta);
