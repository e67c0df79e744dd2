// SPDX-License-Identifier: Apache-2.0
// Pictures of an environment that turns, one a frame.
#pragma once

#include "replay/relight.h"

struct relight_frames {
    const struct tensor *tensor;
    const char *path, *output, *command; // of the tensor; OUT.exr becomes OUT.0001.exr, ...
    int count;
    uint32_t terms; // that a frame may change (replay/follow.h); 0: all
    double turn;    // degrees from each frame to the next
    bool no_device, quiet, json;
    int threads;
};

// Tells of each what it took, as JSON on standard output if asked for. false after an error message.
bool relight_frames_write(const struct relight_frames *f, const struct relight_lighting *first);
