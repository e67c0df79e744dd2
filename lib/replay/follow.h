// SPDX-License-Identifier: Apache-2.0
// Pictures of a relighting tensor under a lighting that changes from frame to frame, by a few
// coefficients each (curve/incremental.h), band by band where they are wavelets.
#pragma once

#include "replay/replay.h"

struct follow;

struct follow_options {
    uint32_t terms;         // that a frame may change
    uint32_t rows, columns; // of cells whose wavelets the coefficients are; 0: of something else
    bool one_band;          // never begin a band anew, for comparison
    bool no_device;
    int threads;
};

// The tensor must outlive it. NULL after an error message.
struct follow *follow_create(const struct tensor *t, const struct follow_options *o);
void follow_destroy(struct follow *f); // NULL is fine

// The next frame: nearer to the picture for weights[coefficient][channel] of block 0. *exact: it is
// that picture, but for rounding.
bool follow_frame(struct follow *f, const float *weights, float *frame, bool *exact);
