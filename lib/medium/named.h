// SPDX-License-Identifier: Apache-2.0
// Measured media by name.
#pragma once

#include "medium/medium.h"

// sigma_s and sigma_t in 1/mm, and the mean cosine of scattering (over the channels, by how much they
// scatter). Upper and lower case are the same. false after an error message that tells the nearest name.
bool named_medium_find(const char *name, struct where at, struct medium_point *c,
                       float *mean_cosine);
// NULL past the end.
const char *named_medium_name(size_t i);
