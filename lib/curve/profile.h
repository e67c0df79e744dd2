// SPDX-License-Identifier: Apache-2.0
// A smooth function of an angle in [0, pi/2], kept as polynomials: to 1e-13 where it bends no
// faster than over 0.02 radians, and quick to evaluate.
#pragma once

#include "curve/curve.h"

enum { PROFILE_PANELS = 128, PROFILE_ORDER = 12 };

struct profile {
    double c[PROFILE_PANELS][PROFILE_ORDER]; // coefficients of Chebyshev polynomials per panel
};

void profile_fit(struct profile *p, curve_fn f, const void *ctx);
double profile_at(const struct profile *p, double x);

// Projected area of facets seen from elevation theta, g(theta) = integral of (h.k)+ p(theta_h) dh,
// for a density of normals p over theta_h (any scale; Ashikhmin, Premoze, Shirley 2000, A
// Microfacet-based BRDF Generator). breaks: of p, as for curve_project.
double facet_area(curve_fn p, const void *ctx, const double *breaks, uint32_t break_count,
                  double theta);
