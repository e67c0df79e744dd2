// SPDX-License-Identifier: Apache-2.0
// --budget of `relume tensor requantise` and `relume precompute edit`.
#pragma once

#include <stdbool.h>

#define BUDGET_HELP                                                                                \
    "store each row of 64 pixels as cheaply (float32 to 2 bits, half resolution, nothing)\n"       \
    "as the error that this adds to edited pictures allows: relmse=1e-4"

// "relmse=X". false after an error message.
bool budget_parse(const char *text, double *relmse);

struct budget_run {
    const char *tensor, *output, *command;
    double relmse;
    int threads;
    bool no_halves, quiet, json;
};

// Stores the tensor anew (in its own place, too) and tells what came of it. false after an error message.
bool budget_run(const struct budget_run *run);
