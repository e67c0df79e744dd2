// SPDX-License-Identifier: Apache-2.0
// From edited forms to the numbers that coefficients are multiplied by (replay/edit_tensor.h).
#pragma once

#include "replay/edit_tensor.h"

// f_q of a block, per channel.
void edit_scale(const struct edit_tensor *e, uint32_t block, float scale[CURVE_CHANNELS]);

// f_o for each pixel of a block, [tile][channel][lane]. false: it is 1, and nothing is written.
bool edit_view_factor(const struct edit_tensor *e, uint32_t block, float *factor);

// The value of a factor: an equivalent albedo
//
//     d = sum over members of their weight times the sum over terms of share f_q mean(f_o) sum_{j,k} cA_j cB_k e[j][k]
//
// (Ben-Artzi 2007, eq. 5.21 to 5.25), mean(f_o) being that over the cosine; or the coefficient of a
// coarse curve, f_q mean(f_o) times the mean of the curve over the bin with e as weights, which
// keeps the albedo.
void edit_factor_value(const struct edit_tensor *e, const struct edited_factor *f,
                       double value[CURVE_CHANNELS]);

// The product of a group's factors, those that `with` says (NULL: all); values[factor][channel].
void edit_group_value(const struct edited_group *g, const double (*values)[CURVE_CHANNELS],
                      const bool *with, double product[CURVE_CHANNELS]);

// weights[group][bin A][bin B][channel] of a block: the products of groups times the curves of the
// axes in `axes` (bit i: axis i); the other axes are left out (one value, 1).
enum { EDIT_ALL_AXES = (1 << TENSOR_MOST_AXES) - 1 };
void edit_weights(const struct edit_tensor *e, uint32_t block,
                  const double (*groups)[CURVE_CHANNELS], uint32_t group_count, unsigned axes,
                  double *weights);
