// SPDX-License-Identifier: Apache-2.0
#include "image/tonemap.h"

#include <math.h>
#include <stddef.h>

const char *const tone_curve_names[] = {"srgb", "filmic", NULL};

// Narkowicz 2015; the curve passes 1 near x = 7.24 and tends to 1.033: clipped there.
static float filmic(float x) {
    return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
}

float tone_map_value(float v, float gain, enum tone_curve curve) {
    const float x = v * gain;
    if (!(x > 0))
        return 0;
    if (x >= 10)
        return 1;
    return fminf(curve == TONE_FILMIC ? filmic(x) : x, 1);
}

void tone_map(struct image *im, double stops, enum tone_curve curve) {
    const size_t n = (size_t)im->width * (size_t)im->height * (size_t)im->channels;
    const float gain = (float)exp2(stops);
    for (size_t i = 0; i < n; i++)
        im->pixels[i] = tone_map_value(im->pixels[i], gain, curve);
}
