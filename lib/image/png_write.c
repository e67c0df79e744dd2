// SPDX-License-Identifier: Apache-2.0
#include <math.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "image/image.h"
#include "image/oiio.h"

static unsigned char encode(float v, bool encoded) {
    const float clipped = v > 0 ? fminf(v, 1) : 0; // NaN becomes 0
    return (unsigned char)((encoded ? clipped : linear_to_srgb(clipped)) * 255 + 0.5f);
}

bool image_write_png(const char *path, const struct image *im) {
    const size_t count = (size_t)im->width * (size_t)im->height, in = (size_t)im->channels;
    const size_t out = in >= 3 ? 3 : 1;
    char temp[4096], message[512] = "";
    if (!oiio_load() || !file_temp_name(path, temp, sizeof temp))
        return false;
    unsigned char *bytes = mem_array(count, out);
    for (size_t p = 0; p < count; p++)
        for (size_t c = 0; c < out; c++)
            bytes[p * out + c] = encode(im->pixels[p * in + c], im->srgb_encoded);
    const bool written = oiio_write_png(temp, bytes, im->width, im->height, (int)out,
                                        !im->srgb_encoded, message, sizeof message);
    mem_free(bytes);
    if (!written) {
        log_error("%s: cannot be written: %s", path, message);
        file_discard(temp);
        return false;
    }
    return file_commit(temp, path);
}
