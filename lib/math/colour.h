// SPDX-License-Identifier: Apache-2.0
// Spectra to linear Rec.709, in the way of Mitsuba 3's RGB variants, so that one scene file means
// the same colours in both.
//
// Wavelengths in nm. Colours are seen by the CIE 1931 2 degree observer, whose y integrates to 1:
// a spectrum that is 1 everywhere has luminance 1. White is D65.
#pragma once

#include <stddef.h>

#include "math/vec.h"

// A piecewise linear spectrum, 0 outside its nodes; wavelengths ascend, count >= 1 (a single node
// is 0 everywhere). lit: it reflects D65 (reflectances, indices); else it is emitted. Not clamped:
// colours outside the gamut have negative lanes.
spectrum colour_from_samples(const double *wavelengths, const double *values, size_t count,
                             bool lit);

// Emission that is 1 at every wavelength: pinkish, since white is D65.
spectrum colour_equal_energy(void);

// Planck's law, in W/(m^2 sr nm), as seen by the observer. kelvin > 0.
spectrum colour_blackbody(double kelvin);

// The sRGB transfer function (IEC 61966-2-1) from and to [0,1]; odd beyond.
float colour_srgb_to_linear(float v);
float colour_linear_to_srgb(float v);
