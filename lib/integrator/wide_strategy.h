// SPDX-License-Identifier: Apache-2.0
// Sampling over the bins of curves (bsdf/bin_sampler.h) for the directions of half the lanes: the operations
// of those for one, lane by lane and with their bits, for the strategies that most models need.
#pragma once

#include "bsdf/bin_sampler.h"
#include "integrator/half_angles.h"

enum { WIDE_STRATEGIES = 6 };

wide_long half_interval(const struct basis *b, wide_double gamma);

bool wide_strategy_fits(const struct bin_sampler *s);
// struct bin_view's reach of each strategy.
void wide_strategy_reach(const struct bin_sampler *s, struct half_directions wo,
                         wide_double reach[WIDE_STRATEGIES]);
wide_double wide_strategy_pdf_sa(const struct bin_sampler *s,
                                 const wide_double reach[WIDE_STRATEGIES], struct half_angles *a);
struct half_directions wide_strategy_sample(const struct bin_sampler *s,
                                        const wide_double reach[WIDE_STRATEGIES],
                                        struct half_directions wo, wide_double left, wide_double u1,
                                        wide_double u2);
