// SPDX-License-Identifier: Apache-2.0
// Equivalent albedo: what a material reflects of uniform light, as if it were Lambertian, for hops at
// which its lobes matter no more (Ben-Artzi 2007, section 5.2.4, eq. 5.21 to 5.25).
//
//     d = sum_j c_j e_j,   e_j = 1/pi integrals of rho_q b_j cos_i cos_o over wi and wo
//
// so that rho = a / pi has d = a. Terms that know theta_i alone are integrated exactly, others by
// quasi-Monte Carlo over wo by its cosine and wi over all bins alike.
#pragma once

#include "curve/form.h"

// e[bin A][bin B][channel] of a term whose curves are tables.
void equivalent_albedo(const struct form *f, uint32_t term, double *e);
