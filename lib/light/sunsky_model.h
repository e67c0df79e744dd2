// SPDX-License-Identifier: Apache-2.0
// Radiance of the clear sky and of the sun's disk.
//
// L. Hosek, A. Wilkie 2012, An Analytic Model for Full Spectral Sky-Dome Radiance; 2013, Adding a
// Solar-Radiance Function to the Hosek-Wilkie Skylight Model. As linear Rec.709, scaled as in
// Mitsuba 3: the spectrum integrated against the observer, over the integral of the observer's y.
// The models can go slightly below zero far from the sun or in a lane out of gamut: clipped to 0.
#pragma once

#include "math/vec.h"

struct sky_model {
    spectrum p[9]; // A to I of equation 8, in the order of the authors' data
    spectrum radiance;
};

// turbidity 1 to 10; sun's elevation 0 to pi/2
void sky_model_init(struct sky_model *m, double turbidity, spectrum albedo, double elevation);
// Towards cos_theta from the zenith, gamma from the sun.
spectrum sky_model_eval(const struct sky_model *m, float cos_theta, float cos_gamma, float gamma);

enum { SUN_KNOTS = 65 };

// The disk, tabulated over the elevations it covers.
struct sun_model {
    float lowest, step;           // elevations of the knots
    spectrum limb[SUN_KNOTS][6];  // polynomial in the cosine on the sun's surface
};

void sun_model_init(struct sun_model *m, double turbidity, double elevation, double half_aperture);
spectrum sun_model_eval(const struct sun_model *m, float elevation, float cos_psi);
