// SPDX-License-Identifier: Apache-2.0
// The blocks of a polynomial tensor for a range of samples, and the sums that fill them.
#pragma once

#include "driver/precompute_polynomial.h"

struct polynomial_layout {
    const struct polynomial *p;
    struct first_seen *seen;
    struct edit_sums_object *objects; // the last one: fixed surfaces
    struct edit_sums_options sums;
    struct tensor_block *blocks;
    uint32_t (*owner)[2];             // by block: object, term
    struct tensor tensor;             // its shape
};

struct polynomial_range {
    uint32_t first, end;       // samples to be traced
    uint32_t before;           // samples of `base`
    const struct tensor *base; // they are added to it, if not NULL
    bool keep_sums;            // so that more can be added later
    enum tensor_storage storage;
    double quantum;
};

// All ranks together (driver/ranks.h). Traces the camera rays of the range, so that every object they
// meet is known, and lays the tensor out. false: stopped, or base does not fit;
// polynomial_layout_finish in either case.
bool polynomial_layout_init(struct polynomial_layout *l, const struct polynomial *p,
                            const struct polynomial_range *r);
void polynomial_layout_finish(struct polynomial_layout *l);

// Ties the sums to the arrays of a file.
void polynomial_layout_tie(struct polynomial_layout *l, struct tensor_writer *w);
uint64_t polynomial_layout_bytes(const struct polynomial_layout *l); // of the file
