// SPDX-License-Identifier: Apache-2.0
// What the values of a picture are like, channel by channel: for `relume info`.
#pragma once

#include <stddef.h>

#include "image/image.h"

struct channel_summary {
    double mean;          // of the finite values
    float smallest, largest; // of the finite values; 0 where there are none
    size_t nans, infinities, negatives;
};

void image_summarize_channel(const struct image *im, int channel, struct channel_summary *s);
