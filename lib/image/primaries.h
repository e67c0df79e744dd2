// SPDX-License-Identifier: Apache-2.0
// Linear RGB spaces of pictures, and from one to the other.
//
// A picture that is not in Rec.709 says so by its attribute `chromaticities` (of EXR; here a text of
// eight numbers: red, green, blue, white, each x and y).
#pragma once

#include "image/image.h"

enum image_space {
    SPACE_REC709,
    SPACE_REC2020, // ITU-R BT.2020
    SPACE_ACESCG,  // AP1, SMPTE ST 2065-1 white (Academy S-2014-004)
    SPACE_ACES,    // AP0, ACES2065-1: the space of interchange (SMPTE ST 2065-1)
};

extern const char *const image_space_names[]; // NULL-terminated, in the order of enum image_space

struct primaries {
    double xy[4][2]; // red, green, blue, white
};

extern const struct primaries image_spaces[];

// Whites are adapted by the matrix of Bradford (Lam 1985). false: the primaries span nothing.
bool primaries_matrix(const struct primaries *from, const struct primaries *to, double m[3][3]);

// Converts all layers with channels R G B from Rec.709, and says so in the attributes.
void image_from_rec709(struct image *im, enum image_space space);
// Brings R G B in the first three channels to Rec.709, by the attribute of the image `of`; where there
// is none they are so already.
void image_rgb_to_rec709(struct image *rgb, const struct image *of);
