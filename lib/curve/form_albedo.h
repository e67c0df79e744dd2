// SPDX-License-Identifier: Apache-2.0
// Equivalent albedos of forms whose curves are tables (Ben-Artzi 2007, eq. 5.24).
#pragma once

#include "curve/form.h"

// Mean of a curve of theta_o over directions to the eye, weighted by their cosine.
double form_view_mean(const struct curve *c, uint32_t channel);

// f_q times the mean of f_o.
void form_term_outer(const struct form *f, uint32_t term, double value[CURVE_CHANNELS]);

// The part of a term: that times the sum over j, k of cA_j cB_k e[j][k][channel], eq. 5.25.
void form_term_albedo(const struct form *f, uint32_t term, const double *e,
                      double value[CURVE_CHANNELS]);
