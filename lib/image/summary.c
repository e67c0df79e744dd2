// SPDX-License-Identifier: Apache-2.0
#include "image/summary.h"

#include <math.h>

void image_summarize_channel(const struct image *im, int channel, struct channel_summary *s) {
    const size_t count = (size_t)im->width * (size_t)im->height;
    size_t finite = 0;
    double sum = 0;
    *s = (struct channel_summary){0};
    for (size_t p = 0; p < count; p++) {
        const float v = im->pixels[p * (size_t)im->channels + (size_t)channel];
        s->nans += isnan(v);
        s->infinities += isinf(v);
        s->negatives += v < 0;
        if (!isfinite(v))
            continue;
        s->smallest = finite == 0 || v < s->smallest ? v : s->smallest;
        s->largest = finite == 0 || v > s->largest ? v : s->largest;
        sum += v;
        finite++;
    }
    s->mean = finite ? sum / (double)finite : 0;
}
