// SPDX-License-Identifier: Apache-2.0
// What exr_read.c and exr_write.c share: the one place that includes OpenEXRCore.
#pragma once

#include <openexr.h>
#include <stddef.h>

enum { EXR_LARGEST_SIDE = 1 << 20 }; // pixels; of a picture or a tile

// What went wrong first, as the library says it.
struct exr_errors {
    char message[512];
};

// A context initialiser whose errors go into *errors (no output), whose single allocations are at
// most 1 GiB and whose pictures and tiles have sides of at most EXR_LARGEST_SIDE.
exr_context_initializer_t exr_initializer(struct exr_errors *errors);
