// SPDX-License-Identifier: Apache-2.0
// How much a coefficient counts in the picture: its root mean square over pixels and channels.
#pragma once

#include "transport/tensor.h"

// out[coefficient]
void importance_of(const struct tensor_block *b, int threads, double *out);
