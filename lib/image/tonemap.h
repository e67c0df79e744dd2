// SPDX-License-Identifier: Apache-2.0
// Tone mapping: from linear radiance to linear display values in [0,1], still without the sRGB
// transfer function (image_write_png applies it).
#pragma once

#include "image/image.h"

enum tone_curve {
    TONE_SRGB,   // clip at 1
    TONE_FILMIC, // ACES fit: K. Narkowicz, "ACES Filmic Tone Mapping Curve" (2015)
};

extern const char *const tone_curve_names[]; // NULL-terminated, in the order of enum tone_curve

// Each value alone: v * 2^stops through the curve. Negative values and NaN become 0, +inf 1.
float tone_map_value(float v, float gain, enum tone_curve curve);
// All values of the picture in place; exposure in stops.
void tone_map(struct image *im, double stops, enum tone_curve curve);
