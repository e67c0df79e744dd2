// SPDX-License-Identifier: Apache-2.0
// What the subcommands that replay tensors have in common: options, pictures, measurements.
#pragma once

#include "base/json.h"
#include "base/options.h"
#include "transport/tensor.h"

struct replay_values {
    const char *output;
    int threads;
    bool variance, no_device, time, quiet, json;
};

// Entries of an option table; `member` is the struct replay_values among the values.
#define REPLAY_OPTIONS(values, member)                                                             \
    {.name = "variance", .type = OPTION_FLAG, .offset = offsetof(values, member.variance),         \
     .help = "write what the tensor's noise makes of the picture as layer `variance`\n"           \
             "(no error of bins or triangles of the sky: `relume verify` tells all)"},              \
    {.name = "no-device", .type = OPTION_FLAG, .offset = offsetof(values, member.no_device),       \
     .help = "do without OpenCL"},                                                                 \
    {.name = "time", .type = OPTION_FLAG, .offset = offsetof(values, member.time),                 \
     .help = "measure: seconds per frame, bytes per second, and what the machine reads"},          \
    OPTION_THREADS(values, member.threads), OPTION_QUIET(values, member.quiet),                    \
    OPTION_JSON(values, member.json)

// What was measured of a picture.
struct replay_timing {
    const char *device;
    uint64_t pixels, coefficients, bytes; // listed; of all blocks; read by a product
    double first, product, frame;         // seconds; product and frame: medians
    double noise;                         // from the half-sums; negative: not known
};

enum { REPLAY_REPEATS = 15 };

// Runs `product` and `frame` (false: failed) several times and fills the medians.
struct replay_measured {
    bool (*product)(void *ctx); // waits until it is done
    bool (*frame)(void *ctx);   // what is left to do for a picture
    void *ctx;
};
bool replay_measure(const struct replay_measured *m, struct replay_timing *t);

// Pixels of all lists, and coefficients of all blocks.
void replay_count(const struct tensor *t, struct replay_timing *timing);

// Messages, unless quiet, and fields of the JSON object.
void replay_report(const struct replay_values *v, const struct replay_timing *t, struct json *out);
