// SPDX-License-Identifier: Apache-2.0
// Mitsuba's volumes, version 3, little-endian: "VOL", version, then int32: encoding, xres, yres,
// zres, channels; the corners of the box in 6 float32; then the values, x fastest. Encodings: 1
// float32, 2 float16, 3 bytes that stand for 0 to 1.
#include <stdint.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "volume/grid.h"

enum { HEADER = 48, FLOAT32 = 1, FLOAT16 = 2, UINT8 = 3 };

static const size_t MOST_BYTES = (size_t)1 << 32;

static uint32_t u32(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static float f32(const unsigned char *p) {
    const uint32_t bits = u32(p);
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static float f16(const unsigned char *p) {
    const uint32_t h = (uint32_t)p[0] | (uint32_t)p[1] << 8;
    const int exponent = (int)(h >> 10 & 31), mantissa = (int)(h & 1023);
    const float sign = h >> 15 ? -1 : 1;
    if (exponent == 31)
        return mantissa ? NAN : sign * INFINITY;
    return sign * (exponent ? ldexpf((float)(1024 + mantissa), exponent - 25)
                            : ldexpf((float)mantissa, -24));
}

static bool read_header(const unsigned char *data, size_t size, const char *path, struct grid *g,
                        int *encoding) {
    if (size < HEADER || memcmp(data, "VOL", 3) != 0) {
        log_error("%s: does not begin as a volume does (\"VOL\")", path);
        return false;
    }
    if (data[3] != 3) {
        log_error("%s: is a volume of version %d, expected 3", path, data[3]);
        return false;
    }
    *encoding = (int)u32(data + 4);
    if (*encoding < FLOAT32 || *encoding > UINT8) {
        log_error("%s: has encoding %d, expected 1 (float32), 2 (float16) or 3 (bytes)", path,
                  *encoding);
        return false;
    }
    for (int k = 0; k < 3; k++)
        g->size[k] = (int)u32(data + 8 + 4 * k);
    g->channels = (int)u32(data + 20);
    return true;
}

static bool read_box(const unsigned char *data, const char *path, struct grid *g) {
    for (int k = 0; k < 3; k++) {
        const double lo = (double)f32(data + 24 + 4 * k), hi = (double)f32(data + 36 + 4 * k);
        if (!(hi > lo) || !isfinite(hi - lo)) {
            log_error("%s: its box runs from %g to %g along %c, expected a finite interval", path,
                      lo, hi, "xyz"[k]);
            return false;
        }
        g->to_file.m[k][k] = hi - lo;
        g->to_file.m[k][3] = lo;
    }
    return true;
}

static bool decode(const unsigned char *data, size_t size, const char *path, struct grid *g) {
    static const size_t bytes[] = {0, 4, 2, 1};
    int encoding;
    if (!read_header(data, size, path, g, &encoding))
        return false;
    // by the size of the file first, so that a damaged header asks for no memory
    const double wanted = (double)g->size[0] * g->size[1] * g->size[2] * g->channels;
    const double held = (double)((size - HEADER) / bytes[encoding]);
    const bool sane = g->size[0] > 0 && g->size[1] > 0 && g->size[2] > 0 && g->channels > 0;
    if (sane && wanted > held) {
        log_error("%s: ends after %.0f of %.0f values", path, held, wanted);
        return false;
    }
    if (!grid_init(g, path) || !read_box(data, path, g))
        return false;
    const unsigned char *p = data + HEADER;
    const size_t n = grid_values(g);
    for (size_t i = 0; i < n; i++, p += bytes[encoding])
        g->values[i] = encoding == FLOAT32   ? f32(p)
                       : encoding == FLOAT16 ? f16(p)
                                             : (float)*p * (1.0f / 255);
    return true;
}

bool grid_read_vol(const char *path, struct grid *g) {
    size_t size;
    char *data = file_read(path, MOST_BYTES, &size);
    if (!data)
        return false;
    const bool good = decode((const unsigned char *)data, size, path, g);
    mem_free(data);
    return good;
}
