// SPDX-License-Identifier: Apache-2.0
// A small edit tensor of random numbers, with all that such a tensor may hold: two objects, of one
// and of two curves, with diffuse terms and f_o, a block that is not edited, and groups of factors.
#pragma once

#include "replay/edit_tensor.h"

enum { SAMPLE_WIDTH = 19, SAMPLE_HEIGHT = 13, SAMPLE_BLOCKS = 4 };

struct sample_options {
    bool polynomial; // groups of factors, and the block of what is not edited
    enum tensor_storage storage;
    uint32_t bins;   // of a curve alone; 0: 32
    uint64_t seed;   // of the values; the objects are the same
};

// The tensor in memory: all of it lives in the arena but meta, which the caller destroys.
struct tensor sample_make(const struct sample_options *o, struct arena *arena);
// The same as a file. false after an error message.
bool sample_write(const struct sample_options *o, const char *path);
// A small tensor for relighting: wavelets over 4x2 cells.
bool sample_write_relight(const char *path);
// What a pixel should be for objects as they are, from the definition, in double.
void sample_truth(const struct edit_tensor *e, double *frame);
