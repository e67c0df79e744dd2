// SPDX-License-Identifier: Apache-2.0
// A tensor whose sums follow changing weights: the whole one, or what a focus leaves of it.
//
// Sums are made anew where weights changed. Where a stage was transformed, a frame may instead change
// the few wavelet coefficients that are furthest off, and make the sums anew when none is.
#pragma once

#include "curve/incremental.h"
#include "replay/replay.h"

struct edit_stage_block {
    float *weights;      // that the sums belong to, [coefficient][channel]
    bool known;          // they belong to some
    bool drifted;        // terms were added since the sums were last made anew
    uint32_t runs, bins; // transformed: runs of so many bins; bins 0: not
    struct incremental effective;
    double *importance; // root mean square of a coefficient over the picture
    uint32_t *index, *order;
    double *difference;
    void *memory; // of values that are its own
};

struct edit_stage {
    struct tensor tensor;
    struct replay *replay;
    struct edit_stage_block *blocks;
    uint32_t terms; // that a frame may change; 0: all
    bool exact;     // since begin
    uint64_t coefficients, bytes; // read since begin
};

// A stage over t, whose blocks it copies (not what they point to). false after an error message.
bool edit_stage_init(struct edit_stage *s, const struct tensor *t, const struct replay_options *o);
void edit_stage_finish(struct edit_stage *s);

// For values of a block's own, aligned as a device wants it; freed with the stage.
float *edit_stage_values(struct edit_stage_block *b, size_t floats);
// Turns those values, runs of `bins` coefficients, into wavelets where their number allows it, and
// takes up the updates of `terms` coefficients.
void edit_stage_transform(struct edit_stage *s, uint32_t block, uint32_t runs, uint32_t bins,
                          int threads);

void edit_stage_begin(struct edit_stage *s);
// Brings a block's sums to the weights, or nearer to them. false after an error message.
bool edit_stage_follow(struct edit_stage *s, uint32_t block, const double *weights);
