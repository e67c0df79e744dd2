// SPDX-License-Identifier: Apache-2.0
// What a few paths tell of the picture as the materials are, before a tensor is traced.
#pragma once

#include "driver/precompute_polynomial.h"

// Above it 1 / (1 - r) says more of the estimate's error than of the light.
#define POLYNOMIAL_MOST_RADIUS 0.98

// A geometric tail: light that scatters more often than a tensor follows it, from what the last bounce
// is of the one before. Where each bounce is r times the one before, those after the last are
// r / (1 - r) times the last. r is a mean over the picture, by channel; the last bounce counts
// 1 / (1 - r) times, and is edited as it is.
//
// r is known to some 0.1 % of it, which is 5 % of the tail where r is 0.98. false after an error
// message: it is too large, or there is only one bounce.
bool polynomial_radius(const struct polynomial *p, uint32_t bounces, double radius[3]);

// Light that each object passes on where it is met after others, within `bounces`, by channel.
void polynomial_passed(const struct polynomial *p, uint32_t bounces,
                       double (*passed)[CURVE_CHANNELS]);
