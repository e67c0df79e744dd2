// SPDX-License-Identifier: Apache-2.0
// Replaying a tensor: pictures for given weights, at the speed of memory.
//
// Works on an OpenCL device where there is one, and on the C twins of its kernels otherwise, with the
// same bits. A tensor that is larger than the device's memory goes through it in chunks. Knows
// nothing of what the weights mean.
#pragma once

#include "transport/tensor.h"

struct replay;
struct contraction;

struct replay_options {
    bool no_device;     // only the C twins
    int threads;        // 0: default
    size_t most_memory; // bytes of values that stay on the device; 0: what it has
    const struct replay *share; // use the device of this one, which must outlive it; NULL: open one
    uint32_t layers;    // of sums a block keeps, which add up to it; 0: 1
};

// The tensor must outlive it. NULL after an error message.
struct replay *replay_create(const struct tensor *t, const struct replay_options *options);
void replay_destroy(struct replay *r); // NULL is fine
const char *replay_device(const struct replay *r); // "C, 2 threads" without one

// The block's sums (its first layer) for weights[coefficient][channel]. false after an error message (device lost).
bool replay_product(struct replay *r, uint32_t block, const float *weights);
// Adds weights of a few terms to the block's sums.
bool replay_update(struct replay *r, uint32_t block, const uint32_t *terms, const float *weights,
                   uint32_t count);
// The same for one layer of the block's sums; and beginning one anew, at zero.
bool replay_update_layer(struct replay *r, uint32_t block, uint32_t layer, const uint32_t *terms,
                         const float *weights, uint32_t count);
bool replay_clear_layer(struct replay *r, uint32_t block, uint32_t layer);
// Fewer coefficients in place of a block's (replay/tiles.h): out[tile][reduced][channel][lane],
// which begins at a multiple of TENSOR_ALIGN.
bool replay_contract(struct replay *r, uint32_t block, const struct contraction *c, float *out);
// Waits until what was asked for is done.
bool replay_wait(struct replay *r);

// What sums are multiplied by on their way into the picture.
struct replay_factors {
    const float *scale;        // [block][channel]; NULL: 1
    const float *const *pixel; // [block]: [tile][channel][lane], or NULL: 1; NULL: all 1
};

// The picture: fixed + sum over blocks of their sums times factors (NULL: 1), three planes of
// width * height.
bool replay_frame(struct replay *r, const struct replay_factors *factors, float *frame);

// The variance that the halves tell of for these weights (all blocks, one after the other), per
// pixel: mean over channels of the squared half difference; zero where a block has no halves.
void replay_variance(struct replay *r, const float *const *weights,
                     const struct replay_factors *factors, float *variance);
