// SPDX-License-Identifier: Apache-2.0
// Joint shares with given sums: rows and columns that have too much are scaled down, then what is
// missing is added as a product (Altschuler, Weed and Rigollet 2017, algorithm 2). Exact, and
// nothing becomes negative.
#pragma once

#include <stdint.h>

#include "base/mem.h"

// share[i * stride + k] for rows first[0] <= i < end[0] and columns first[1] <= k < end[1]; sum[0][i] of
// row i, sum[1][k] of column k, or NULL: what these have is kept but for what the others ask for. Where
// both are given their totals are the same. scratch: rows + columns.
void joint_fit(double *share, uint32_t stride, const uint32_t first[2], const uint32_t end[2],
               const double *const sum[2], double *scratch);
