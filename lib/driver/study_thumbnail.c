// SPDX-License-Identifier: Apache-2.0
// Small pictures inside a page.
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "driver/study_error.h"
#include "image/tonemap.h"

enum { WIDEST = 200 };

// RFC 4648.
static char *data_uri(const unsigned char *bytes, size_t size) {
    static const char head[] = "data:image/png;base64,";
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *text = mem_array(sizeof head + (size + 2) / 3 * 4, 1);
    char *out = text + sizeof head - 1;
    memcpy(text, head, sizeof head);
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const unsigned v = (unsigned)bytes[i] << 16 | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
                           (left > 2 ? bytes[i + 2] : 0);
        *out++ = digits[v >> 18];
        *out++ = digits[v >> 12 & 63];
        *out++ = left > 1 ? digits[v >> 6 & 63] : '=';
        *out++ = left > 2 ? digits[v & 63] : '=';
    }
    return text;
}

static char *embed(const struct image *im, const char *temp) {
    struct image small;
    size_t size;
    const int factor = (im->width + WIDEST - 1) / WIDEST;
    if (!image_downsample(im, factor, &small))
        return NULL;
    char *bytes = image_write_png(temp, &small) ? file_read(temp, 0, &size) : NULL;
    char *uri = bytes ? data_uri((const unsigned char *)bytes, size) : NULL;
    mem_free(bytes);
    file_discard(temp);
    image_finish(&small);
    return uri;
}

char *study_thumbnail(const struct study_reference *ref, const struct image *im, const char *temp) {
    struct image shown;
    if (!image_init(&shown, im->width, im->height, 3))
        return NULL;
    memcpy(shown.pixels, im->pixels, 3 * sizeof(float) * (size_t)im->width * (size_t)im->height);
    tone_map(&shown, log2(0.3 / ref->mean), TONE_FILMIC);
    char *uri = embed(&shown, temp);
    image_finish(&shown);
    return uri;
}

char *study_difference(const struct study_reference *ref, const struct image *im, const char *temp) {
    struct image shown;
    if (!image_init(&shown, im->width, im->height, 3))
        return NULL;
    for (size_t p = 0; p < (size_t)im->width * (size_t)im->height; p++) {
        const float b = rgb_luminance(ref->rgb.pixels + 3 * p);
        const float e = (rgb_luminance(im->pixels + 3 * p) - b) / (fabsf(b) + (float)(0.01 * ref->mean));
        float *out = shown.pixels + 3 * p;
        out[0] = e > 0 ? e : fmaxf(-e - 1, 0);
        out[2] = e < 0 ? -e : fmaxf(e - 1, 0);
        out[1] = fmaxf(fabsf(e) - 1, 0);
    }
    char *uri = embed(&shown, temp);
    image_finish(&shown);
    return uri;
}
