// SPDX-License-Identifier: Apache-2.0
// Whether the coefficients of two tensors mean the same, so that they can be added.
#pragma once

#include "transport/tensor.h"

// A key of the metadata whose values differ; NULL: none. How many samples there are, and of which seed,
// does not matter.
const char *tensor_other_meaning(const struct json *a, const struct json *b);

bool tensor_same_block(const struct tensor_block *a, const struct tensor_block *b);

// Whether two values of metadata are equal.
bool tensor_same_value(const struct json *a, const struct json *b);
