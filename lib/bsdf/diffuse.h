// SPDX-License-Identifier: Apache-2.0
// The data of Lambert's law, shared by its two ways of being shaded.
#pragma once

#include "bsdf/bsdf_wide.h"

struct diffuse {
    struct texture_ref reflectance;
};

extern const struct wide_bsdf diffuse_wide;
