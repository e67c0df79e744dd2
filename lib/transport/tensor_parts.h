// SPDX-License-Identifier: Apache-2.0
// What tensors are parts of, as their metadata tell: the mean of independent ones, which differ in
// their seeds, or the sum over ranges of lights.
#pragma once

#include "transport/tensor.h"

int64_t tensor_samples(const struct tensor *t);

// Whether these are ranges of lights rather than the same lights with other seeds.
bool tensor_are_ranges(const struct tensor *const *t, size_t count);

// Writes into the metadata of the whole what it is made of: "merged", the seeds; or "range", that of
// all. false after an error message, by path: two of one seed; ranges with gaps, of different seeds.
bool tensor_list_seeds(const struct tensor *const *t, const char *const *paths, size_t count,
                       struct json *meta);
bool tensor_join_ranges(const struct tensor *const *t, const char *const *paths, size_t count,
                        struct json *meta);
