// SPDX-License-Identifier: Apache-2.0
// The C face of oiio.cpp, the one file that includes OpenImageIO.
//
// OpenImageIO brings 260 shared objects, which take a third of a second to load. So oiio.cpp is a
// module of its own, librelume_oiio.so, that oiio.c loads when the first picture needs it: from
// ../lib or ../lib/relume beside the folder of the program.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "image/decode.h"
#include "image/primaries.h"

// Loads the module; false after an error message. Call it before the child is forked: the children
// then inherit it.
bool oiio_load(void);
// Writes 8-bit samples (1 to 4 channels, interleaved, lines from the top) as PNG, labelled as sRGB or
// not at all. false: message (size n) says why. After oiio_load.
bool oiio_write_png(const char *path, const unsigned char *bytes, int width, int height,
                    int channels, bool srgb, char *message, size_t n);

// What the module may call here, and the functions that it exports.
struct oiio_host {
    bool (*init_image)(struct decoder_input *in, struct image *im, int64_t width, int64_t height,
                       int64_t channels);
    void (*set_text)(struct image *im, const char *name, const char *text);
    void (*from_rec709)(struct image *im, enum image_space space);
};

typedef bool oiio_module_decode_function(const struct oiio_host *host, struct decoder_input *in,
                                         struct image *im);
typedef bool oiio_module_write_png_function(const char *path, const unsigned char *bytes, int width,
                                            int height, int channels, bool srgb, char *message,
                                            size_t n);
