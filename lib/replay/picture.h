// SPDX-License-Identifier: Apache-2.0
// Replayed pictures as files.
#pragma once

#include "transport/tensor.h"

// Writes three planes as layers R G B, and variance.Y where variance is not NULL. Values that are
// not finite are an error: the tensor is damaged. false after an error message.
bool picture_write(const char *path, const struct tensor *t, const float *frame,
                   const float *variance, const char *command, const char *version);
