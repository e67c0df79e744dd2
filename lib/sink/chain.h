// SPDX-License-Identifier: Apache-2.0
// Chains: what a path's weight is still to be multiplied by, once the materials are known.
//
// An editable surface answers not with a value but with (mark, weight) pairs, one for each basis
// function that is not zero there: several where terms, hats or slots overlap. A path carries the
// marks of its vertices in two lists, whose product of pairs is meant: of what is seen first, places
// among the coefficients of that object; of all later vertices together, groups, which are products
// of factors such as another object's albedo.
//
// A light sample leaves a vertex in another direction than the path, so the last vertex whose marks
// depend on direction has a list for either way.
#pragma once

#include <stdint.h>

#include "math/vec.h"

enum { CHAIN_MARKS = 64, CHAIN_FIXED = -1 };

enum chain_way { CHAIN_PATH, CHAIN_LIGHT, CHAIN_WAYS };

struct mark {
    uint32_t index; // of a place, or of a group
    spectrum weight;
};

struct marks {
    uint32_t count;
    struct mark mark[CHAIN_MARKS];
};

struct chain {
    int object;    // what is seen first; CHAIN_FIXED: nothing that can be edited
    const void *basis; // the response's own: what the marks of `first` are made from
    float view;    // angle between its normal and the eye
    uint8_t first_of_light, later_of_light; // enum chain_way: the list that a light sample takes
    struct marks first[CHAIN_WAYS];
    struct marks later[CHAIN_WAYS];
    struct marks met; // of the path as it came to a vertex that adds several to each
};

static inline void marks_one(struct marks *m, uint32_t index) {
    m->count = 1;
    m->mark[0] = (struct mark){index, spectrum_grey(1)};
}

// A path that has met nothing yet.
static inline void chain_begin(struct chain *c) {
    c->object = CHAIN_FIXED;
    c->view = 0;
    c->first_of_light = c->later_of_light = CHAIN_PATH;
    marks_one(&c->first[CHAIN_PATH], 0);
    marks_one(&c->later[CHAIN_PATH], 0);
}
