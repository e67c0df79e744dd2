// SPDX-License-Identifier: Apache-2.0
// The coefficients of a relighting tensor as one EXR file, for programs that do not read tensors: a
// game engine adds its layers up itself.
#pragma once

#include "transport/tensor.h"

enum { EXPORT_MOST = 1024 }; // coefficients: EXR readers keep all channels of a line

// A layer R, G, B for each coefficient, to be multiplied by its weight and added up: named as the
// light or group; "sh_L_M" of the harmonic Y_LM (math/directions.h); "cell_ROW_COLUMN"; "wavelet_ROW_COLUMN"
// of the transformed cells. "fixed" is what no weight changes. false after an error message.
bool export_coefficients(const struct tensor *t, const char *path, const char *output,
                         const char *command, const char *version);
