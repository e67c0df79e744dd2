// SPDX-License-Identifier: Apache-2.0
// A picture of a quantity: its luminance as colour, by a logarithmic or linear scale that stands
// beside it.
#pragma once

#include "image/image.h"

struct false_colour {
    double factor;      // from luminance to what the legend counts
    const char *unit;   // beside the legend
    double low, high;   // ends of the scale, in that unit; both 0: by the picture
    bool linear;        // else logarithmic
};

// From linear Rec.709 (3 channels) to display values, with the legend at the right. Where there is
// nothing above 0 all is at the lower end. false after an error message.
bool false_colour_map(const struct image *rgb, const struct false_colour *options,
                      struct image *out);
