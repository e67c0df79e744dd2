// SPDX-License-Identifier: Apache-2.0
// Sampling over the bins of curves (bsdf/bin_sampler.h) for eight directions at once: the operations
// of those for one, lane by lane and with their bits, for the strategies that most models need.
#pragma once

#include "bsdf/bin_sampler.h"
#include "math/wide_double.h"

enum { WIDE_STRATEGIES = 6 };

struct directions8 {
    wide_double x, y, z;
};

// As struct angles, without what depends on the azimuth of h.
struct angles8 {
    struct directions8 wo, wi;
    wide_double length; // of h = wi + wo
    wide_double cos_d, sin_d, cos_h, sin_h;
    wide_double gamma[GAMMA_COUNT];
    uint32_t known; // gammas that were asked for already, a bit each
};

static inline struct directions8 directions8_of(wide_double x, wide_double y, wide_double z) {
    const wide_double inv = 1 / wide_double_sqrt(x * x + y * y + z * z);
    return (struct directions8){x * inv, y * inv, z * inv};
}

struct angles8 angles8_between(struct directions8 wo, struct directions8 wi);
// Of theta_h, theta_d, theta_i and theta_r.
bool gamma8_fits(enum gamma_kind kind);
wide_double gamma8_at(enum gamma_kind kind, struct angles8 *a);
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
