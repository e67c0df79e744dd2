// SPDX-License-Identifier: Apache-2.0
// The C face of oiio.cpp, the one file that includes OpenImageIO. Decoding is declared in decode.h.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

// Writes 8-bit samples (1 to 4 channels, interleaved, lines from the top) as PNG. false: message
// (size n) says why.
bool oiio_write_png(const char *path, const unsigned char *bytes, int width, int height,
                    int channels, char *message, size_t n);

#ifdef __cplusplus
}
#endif
