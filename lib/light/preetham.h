// SPDX-License-Identifier: Apache-2.0
// Luminance and colour of the clear sky (A. Preetham, P. Shirley, B. Smits 1999, A Practical Analytic
// Model for Daylight, appendix A.2), as linear Rec.709, scaled as sunsky_model.h is.
#pragma once

#include "math/vec.h"

struct preetham_sky {
    float perez[3][5]; // A to E of equation 3 for Y, x, y
    float zenith[3];   // Y, x, y over the distribution's value there
};

// turbidity 1 to 10 (the paper: 2 to 10; below that the zenith would be dark); elevation 0 to pi/2
void preetham_sky_init(struct preetham_sky *s, double turbidity, double elevation);
// Towards cos_theta >= 0 from the zenith, gamma from the sun.
spectrum preetham_sky_eval(const struct preetham_sky *s, float cos_theta, float cos_gamma,
                           float gamma);
