// SPDX-License-Identifier: Apache-2.0
#include "image/display.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "image/oiio.h"

// OpenColorIO has configurations of its own (ocio://...) from version 2.2 on.
static bool is_built_in(const char *config) {
    return strncmp(config, "ocio://", 7) == 0;
}

bool image_display(const char *config, const char *display, const char *view, const char *from,
                   struct image *rgb) {
    const char *variable = getenv("OCIO");
    config = config ? config : variable && *variable ? variable : NULL;
    if (!config) {
        log_error("a view needs an OpenColorIO configuration: --ocio FILE, or the variable OCIO");
        return false;
    }
    if (!is_built_in(config) && !file_exists(config)) {
        log_error("%s: no such OpenColorIO configuration", config);
        return false;
    }
    const struct display_view v = {config, display, view, from, rgb};
    const size_t bytes = (size_t)rgb->width * (size_t)rgb->height * 3 * sizeof *rgb->pixels;
    struct image shown = {0};
    if (!oiio_load() || !image_decode_bytes_in_child(config, &v, bytes, oiio_display, &shown)) {
        if (is_built_in(config))
            log_info("built-in configurations need OpenColorIO 2.2 or later, and OpenImageIO 2.5");
        return false;
    }
    image_finish(rgb);
    *rgb = shown;
    return true;
}
