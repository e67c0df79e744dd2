// SPDX-License-Identifier: Apache-2.0
// Sampling of directions for a material whose curves are not known yet: every bin of every curve is
// as likely as the others, so that none is left to a few lucky samples.
//
// A mixture of the cosine and, for each curve under the integral, directions whose gamma falls into
// its bins with the same probability. One random number chooses strategy and bin, so points that
// are well distributed in it fill the bins alike. (Mixtures of a cosine and one gloss leave bin 0 of
// 256 with 26 % noise: Ben-Artzi 2007, section 6.1.1.) Of the bins over theta_h only those are drawn
// that wo can see.
#pragma once

#include "bsdf/curve_sampler.h"

enum { BIN_STRATEGIES = 1 + 2 * FORM_TERMS };

struct bin_sampler {
    uint32_t count;
    struct curve_strategy strategy[BIN_STRATEGIES]; // the cosine first
};

// The sampler as seen from wo, above the surface.
struct bin_view {
    struct direction wo;
    double reach[BIN_STRATEGIES]; // part of a strategy's bins that wo can see
};

// For a form whose curves are tables, whatever their values; memory from the arena.
void bin_sampler_init(struct bin_sampler *s, const struct form *f, struct arena *arena);
struct bin_view bin_sampler_view(const struct bin_sampler *s, struct direction wo);
// Density per solid angle of wi above the surface.
double bin_sampler_pdf_sa(const struct bin_sampler *s, const struct bin_view *v,
                          struct direction wi, struct angles *a);
// u1 chooses strategy and bin, u2 the azimuth, left between the two images of a half vector; the
// direction may lie below.
struct direction bin_sampler_sample(const struct bin_sampler *s, const struct bin_view *v,
                                    double left, double u1, double u2);
