// SPDX-License-Identifier: Apache-2.0
#include "replay/picture.h"

#include <math.h>
#include <stdio.h>

#include "base/log.h"
#include "image/image.h"

static bool is_finite(const char *path, const struct tensor *t, const float *frame) {
    const size_t plane = (size_t)t->width * t->height;
    for (size_t i = 0; i < 3 * plane; i++)
        if (!isfinite(frame[i])) {
            log_error("%s: pixel %zu,%zu is not finite: the tensor holds such values (relume tensor "
                      "check), or the weights are too large", path, i % plane % t->width,
                      i % plane / t->width);
            return false;
        }
    return true;
}

bool picture_write(const char *path, const struct tensor *t, const float *frame,
                   const float *variance, const char *command, const char *version) {
    struct image im;
    const size_t plane = (size_t)t->width * t->height, channels = variance ? 4 : 3;
    if (!is_finite(path, t, frame) ||
        !image_init(&im, (int)t->width, (int)t->height, (int)channels))
        return false;
    for (size_t i = 0; i < plane; i++) {
        for (size_t k = 0; k < 3; k++)
            im.pixels[i * channels + k] = frame[k * plane + i];
        if (variance)
            im.pixels[i * channels + 3] = variance[i];
    }
    if (variance)
        snprintf(im.channel_names[3], IMAGE_NAME_SIZE, "variance.Y");
    image_set_text(&im, "relume.command", command);
    image_set_text(&im, "relume.version", version);
    image_set_text(&im, "relume.colourSpace", "linear Rec.709");
    const bool written = image_write_exr(path, &im, NULL);
    image_finish(&im);
    return written;
}
