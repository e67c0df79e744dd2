// SPDX-License-Identifier: Apache-2.0
// Photometric profiles: luminous intensity over direction as goniophotometers measure it, from files
// of the Illuminating Engineering Society (LM-63-1986, -1991, -1995, -2002, -2019).
//
// Local directions: +z is the photometric zero (straight down from a ceiling luminaire), -z up, +x
// the photometric horizontal. Type C: vertical angle from +z, horizontal angle counterclockwise as
// seen from above, from +x through -y. Type B: planes about the horizontal axis y, turned by the
// vertical angle from +z towards +x; the horizontal angle leaves the plane towards +y. Type A:
// planes about the vertical axis, clockwise from +x through +y by the horizontal angle; the vertical
// angle rises from the horizon.
#pragma once

#include "math/vec.h"

enum ies_type { IES_TYPE_C = 1, IES_TYPE_B = 2, IES_TYPE_A = 3 }; // as numbered in the files

struct ies_profile {
    enum ies_type type;
    uint32_t vertical_count, horizontal_count;
    float *vertical, *horizontal; // degrees, increasing; owned
    float *candela;               // [horizontal][vertical], multipliers applied, >= 0; owned
    float tilt;                   // factor of the lamp at the tilt asked for; applied already
    uint32_t negative;            // candela values that were below zero and count as zero
};

// tilt_degrees: how far the luminaire is tilted from where it was measured. false after an error
// message; *profile is then empty.
bool ies_profile_read(const char *path, float tilt_degrees, struct ies_profile *profile);
void ies_profile_finish(struct ies_profile *profile);

// Candela towards unit w (local), bilinear in the angles; 0 where nothing was measured.
float ies_profile_eval(const struct ies_profile *profile, vec3 w);
// Integral over all directions, in lumen.
float ies_profile_flux(const struct ies_profile *profile);
// Cosine of the half angle about +z beyond which there is nothing; -1 where that is not known.
float ies_profile_cone(const struct ies_profile *profile);
