// SPDX-License-Identifier: Apache-2.0
// Sampling over the bins of curves (bsdf/bin_sampler.h) for eight directions at once: the operations
// of those for one, lane by lane and with their bits, for the strategies that most models need.
#pragma once

#include "bsdf/bin_sampler.h"
#include "integrator/angles8.h"

enum { WIDE_STRATEGIES = 6 };

wide_long basis8_interval(const struct basis *b, wide_double gamma);

bool wide_strategy_fits(const struct bin_sampler *s);
// struct bin_view's reach of each strategy.
void wide_strategy_reach(const struct bin_sampler *s, struct directions8 wo,
                         wide_double reach[WIDE_STRATEGIES]);
wide_double wide_strategy_pdf_sa(const struct bin_sampler *s,
                                 const wide_double reach[WIDE_STRATEGIES], struct angles8 *a);
struct directions8 wide_strategy_sample(const struct bin_sampler *s,
                                        const wide_double reach[WIDE_STRATEGIES],
                                        struct directions8 wo, wide_double left, wide_double u1,
                                        wide_double u2);
