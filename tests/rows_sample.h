// SPDX-License-Identifier: Apache-2.0
// A block of random coefficients whose rows are stored in all ways by turns.
#pragma once

#include "base/mem.h"
#include "transport/tensor.h"

// The block of `pixels` pixels (0, 1, ...), in memory of the arena, aligned as a device wants it.
struct tensor_block rows_sample(uint64_t pixels, uint32_t coefficients, struct arena *arena);
// Encodes rows in these ways, [tile][coefficient]; values [tile][coefficient][channel][lane].
struct tensor_rows rows_encode(const uint8_t *ways, const float *values, uint64_t tiles,
                               uint32_t coefficients, const void **data, struct arena *arena);
