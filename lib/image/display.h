// SPDX-License-Identifier: Apache-2.0
// Views of OpenColorIO configurations: what a colour pipeline shows of a picture on a display.
//
// OpenImageIO applies them, in a child process as decoders are: configurations and the tables that
// they name are files of others.
#pragma once

#include "image/image.h"

struct display_view {
    const char *config;        // a file, or what OpenColorIO takes for one (ocio://default)
    const char *display, *view; // NULL: the configuration's default
    const char *from;          // its colour space or role of linear Rec.709; NULL: to be found
    const struct image *picture;
};

// Turns a linear Rec.709 picture (3 channels) into what the display is sent. config NULL: the file
// that the variable OCIO names. false after an error message, which lists what there is.
bool image_display(const char *config, const char *display, const char *view, const char *from,
                   struct image *rgb);
