// SPDX-License-Identifier: Apache-2.0
// New tensors from old ones: the mean of independent ones, a part of the picture, other storage.
//
// Tensors of one scene that differ in their seeds merge to the exact mean, weighted by their samples
// (in double, rounded once); halves too, so that the error told is that of the merged tensor. A list
// of pixels becomes the union of the lists. Ranges of samples of one seed that kept their sums merge to
// the bits of one run over all of them, and keep their sums; nothing else does. Ranges of lights of one
// seed, which follow each other without gap, merge to their sum (driver/precompute_edit.h: metadata
// "range"). The metadata get "samples", their sum, and "merged", [{"seed", "samples"}, ...], by which a tensor is refused that is already part of another.
#pragma once

#include "transport/tensor.h"

struct tensor_remake {
    const char *const *paths; // the sources
    size_t count;
    uint32_t crop[4];   // x0, y0, x1, y1 (just past the last): the new picture; all 0: all of it
    bool drop_zeros;    // pixels whose coefficients are all zero leave the lists
    bool new_storage;   // else that of the first source, or F32 in place of rows
    enum tensor_storage storage;
    const char *command; // for the metadata
};

struct tensor_remade {
    uint64_t samples, pixels, dropped, bytes; // of the new tensor; listed pixels; file
    double worst; // largest change of a coefficient by storage, over the largest coefficient
};

// false after an error message.
bool tensor_remake(const struct tensor_remake *o, const char *output, struct tensor_remade *result);

// What a tensor holds, as `relume tensor info` tells it.
void tensor_describe(const struct tensor *t, struct json *out);
