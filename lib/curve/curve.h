// SPDX-License-Identifier: Apache-2.0
// Tabulated curves: coefficients over a basis, one set per channel.
//
// A curve is what a person edits; coefficients are never negative. They come from a function by a
// weighted mean over each basis function b_j,
//
//     c_j = integral of f b_j w / integral of b_j w
//
// never by looking at points alone, so that a feature narrower than a bin is neither lost nor
// popping while it moves. The mean keeps the integral of f w exactly, for boxes and hats alike.
// With w = sin gamma that is what light sees of a curve of a polar angle: a plain mean over-weights
// the middle of the highlight, by 75 % for an exponent of 200 in 8 bins.
#pragma once

#include "curve/basis.h"

enum { CURVE_CHANNELS = 3 };

struct curve {
    struct basis basis;
    uint32_t channels; // 1: the same in all; 3
    double *values;    // [channels][basis.count]
};

enum curve_filter {
    FILTER_SINE,  // w = sin gamma
    FILTER_MEAN,  // w = 1
    FILTER_POINT, // the value at a bin's middle or at a node
};

typedef double (*curve_fn)(const void *ctx, double gamma);

// All values zero.
struct curve curve_make(struct arena *arena, const struct basis *basis, uint32_t channels);

// Fills one channel from a function. breaks: where the function jumps or bends, ascending (may be
// none); what it does next to knots and breaks is resolved down to 1e-5 radians.
void curve_project(struct curve *c, uint32_t channel, curve_fn f, const void *ctx,
                   enum curve_filter filter, const double *breaks, uint32_t break_count);

// The same curve over another basis; over its own basis nothing changes.
void curve_resample(struct curve *c, const struct curve *from, enum curve_filter filter);

// Value at gamma, 0 beyond the last knot.
double curve_at(const struct curve *c, uint32_t channel, double gamma);

// One channel of a curve, as a curve_fn.
struct curve_channel {
    const struct curve *curve;
    uint32_t index;
};

double curve_channel_at(const void *channel, double gamma);

static inline const double *curve_values(const struct curve *c, uint32_t channel) {
    return c->values + (size_t)(c->channels > 1 ? channel : 0) * c->basis.count;
}

// ---- files (curve_csv.c) --------------------------------------------------------------------
//
// A header line names the columns, then one line a bin or node, in degrees:
//
//     from,to,r,g,b    boxes: bins that follow each other from 0 to 90
//     at,r,g,b         hats: nodes that ascend from 0 to 90
//
// One column "value" in place of r,g,b is the same in all channels. Lines that start with # and
// empty lines are skipped.

// false after an error message: not such a file, negative or infinite values, gaps.
bool curve_read(struct curve *c, struct arena *arena, const char *path);
// The same from memory (text ends with a zero byte); path is for messages.
bool curve_parse(struct curve *c, struct arena *arena, const char *text, const char *path);
// Numbers come back the same bits. false after an error message.
bool curve_write(const struct curve *c, const char *path);
