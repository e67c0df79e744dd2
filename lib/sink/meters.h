// SPDX-License-Identifier: Apache-2.0
// The sink of a list of points (sensor/points.h): a tile is a point, and its sixteen pixels are
// replicates, whose spread is the error of their mean.
#pragma once

#include "sink/sink.h"

enum { METER_REPLICATES = SINK_LANES };

struct meter {
    double sums[METER_REPLICATES][3]; // of samples
    bool done;                        // nothing more is wanted of it
};

struct meters {
    uint32_t first;      // number of meters[0] in the list, and its tile
    struct meter *items;
    // Where the sixteen pixels of a tile begin.
    void (*corner)(uint32_t tile, int *x, int *y);
    _Atomic unsigned long long rejected; // samples that were not finite; they count as black
};

struct sink *meters_sink(void *meters);

struct meter_reading {
    double mean[3], error[3];           // and standard errors
    double luminance, luminance_error;  // Rec.709
};

// After `samples` samples of each replicate.
struct meter_reading meter_read(const struct meter *m, uint64_t samples);
