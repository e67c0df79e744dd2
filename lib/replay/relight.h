// SPDX-License-Identifier: Apache-2.0
// Weights of a relighting tensor: which lighting its pictures are replayed under.
#pragma once

#include "transport/tensor.h"

struct relight_lighting {
    const char *environment;    // picture of an environment, latitude-longitude; NULL: the scene's own
    double rotate;              // of either, degrees about +y, from +z towards +x
    const char *const *lights;  // "NAME=R,G,B" or "NAME=X": factors of light groups
    size_t light_count;
    uint32_t terms;             // keep so many largest coefficients of wavelets; 0: all
};

// weights[coefficient][channel] for block 0 of the tensor of `path`. false after an error message.
bool relight_weights(const struct tensor *t, const char *path, const struct relight_lighting *l,
                     float *weights);
