// SPDX-License-Identifier: Apache-2.0
// What replaying costs, and what the machine could do at best.
#pragma once

#include "transport/tensor.h"

// The middle of n values, which are put in order.
double measure_median(double *values, size_t n);

// Bytes per second at which all threads together read memory (the median of several runs over at
// least 256 MB), measured now.
double measure_bandwidth(int threads);

// Root of the mean of relative variances of a picture of three planes: what `render` calls noise.
double measure_noise(const struct tensor *t, const float *frame, const float *variance);
