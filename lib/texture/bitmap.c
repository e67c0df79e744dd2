// SPDX-License-Identifier: Apache-2.0
// Pictures as textures. Row 0 of the file is at v = 0 and pixel centres are at half-integers, as in
// Mitsuba. Files of 8 bits stay so in memory, behind a table that linearises; others are kept in
// half precision where that loses nothing.
#include <string.h>

#include "image/image.h"
#include "texture/uv.h"

enum wrap { WRAP_REPEAT, WRAP_MIRROR, WRAP_CLAMP, WRAP_ZERO, WRAP_ONE };
enum filter { FILTER_BILINEAR, FILTER_NEAREST };
enum storage { STORE_U8, STORE_HALF, STORE_FLOAT };

struct bitmap {
    const char *filename, *channel;
    int filter, wrap;
    bool raw;
    float gamma;
    struct uv_mapping uv;
    // made by prepare
    int width, height, channels; // 1 or 3 channels
    enum storage storage;
    void *texels;
    float *decode; // STORE_U8: 256 values
    spectrum mean;
    struct texture_range range;
};

static const char *const filters[] = {"bilinear", "nearest", "trilinear", "ewa", NULL};
static const char *const wraps[] = {"repeat", "mirror", "clamp", "zero", "one", NULL};

static const struct param params[] = {
    {"filename", PARAM_FILE, offsetof(struct bitmap, filename), .unit = "",
     .help = "picture: EXR, PNG, JPEG, HDR, TGA, ..."},
    {"filter_type", PARAM_CHOICE, offsetof(struct bitmap, filter), .def = "bilinear", .unit = "",
     .help = "trilinear and ewa mean bilinear", .choices = filters},
    {"wrap_mode", PARAM_CHOICE, offsetof(struct bitmap, wrap), .def = "repeat", .unit = "",
     .help = "what lies outside of the unit square", .choices = wraps},
    {"raw", PARAM_BOOL, offsetof(struct bitmap, raw), .def = "false", .unit = "",
     .help = "numbers, not colours: nothing is linearised"},
    {"gamma", PARAM_FLOAT, offsetof(struct bitmap, gamma), .def = "0", .min = -1, .max = 10,
     .unit = "", .help = "exponent that linearises (0: as the file says, -1: sRGB)"},
    {"channel", PARAM_STRING, offsetof(struct bitmap, channel), .unit = "", .optional = true,
     .help = "use only this channel (r, g, b, a or a name)"},
    UV_PARAMS(struct bitmap, uv),
    {"format", PARAM_IGNORED, 0, .unit = "", .help = "storage is chosen by the data"},
    {"accel", PARAM_IGNORED, 0, .unit = "", .help = "no graphics hardware is used"},
    {"cache", PARAM_IGNORED, 0, .unit = "", .help = "no cache is needed"},
    {"max_anisotropy", PARAM_IGNORED, 0, .unit = "", .help = "lookups are not filtered"},
    PARAM_END,
};

// ---- half precision -------------------------------------------------------------------------

// Exponents are shifted by a multiplication, which also handles subnormals and infinity.
static float half_to_float(uint16_t h) {
    const uint32_t bits = (uint32_t)(h & 0x7fff) << 13;
    float magnitude;
    memcpy(&magnitude, &bits, sizeof magnitude);
    magnitude *= 0x1p112f;
    return h & 0x8000 ? -magnitude : magnitude;
}

// The half that is exactly x; false: there is none.
static bool float_to_half(float x, uint16_t *h) {
    const float scaled = fabsf(x) * 0x1p-112f;
    uint32_t bits;
    memcpy(&bits, &scaled, sizeof bits);
    *h = (uint16_t)((bits >> 13) | (signbit(x) ? 0x8000 : 0));
    return fabsf(x) <= 65504 && half_to_float(*h) == x;
}

// ---- reading --------------------------------------------------------------------------------

// Channels of the picture that become the texture's; false after an error message.
static bool choose_channels(const struct bitmap *self, const struct image *im, int channel[3],
                            int *count) {
    if (self->channel) {
        static const char *const names[] = {"R", "G", "B", "A"};
        const char *const at = strchr("rgba", self->channel[0]);
        const bool letter = at && *at && !self->channel[1];
        channel[0] = image_find_channel(im, letter ? names[at - "rgba"] : self->channel);
        *count = 1;
        if (channel[0] < 0)
            log_error("%s: no channel \"%s\" was found", self->filename, self->channel);
        return channel[0] >= 0;
    }
    static const char *const rgb[] = {"R", "G", "B"};
    *count = 3;
    for (int c = 0; c < 3; c++)
        channel[c] = image_find_channel(im, rgb[c]);
    if (channel[0] >= 0 && channel[1] >= 0 && channel[2] >= 0)
        return true;
    const int y = image_find_channel(im, "Y");
    channel[0] = y >= 0 ? y : 0;
    *count = 1;
    return true;
}

static float linearise(const struct bitmap *self, const struct image *im, float v) {
    if (self->raw)
        return v;
    if (self->gamma > 0)
        return powf(maxf(v, 0), self->gamma);
    return self->gamma < 0 || im->srgb_encoded ? srgb_to_linear(v) : v;
}

// What a channel of the file means; what no colour can be, NaN and infinity, becomes 0 and is no longer
// good.
static float value_of(const struct bitmap *self, const struct image *im, float v, bool *good) {
    const float linear = linearise(self, im, v);
    const bool finite = isfinite(v) && isfinite(linear);
    *good = *good && finite;
    return finite ? linear : 0;
}

static void store_bytes(struct bitmap *self, const struct image *im, const int channel[3]) {
    const size_t pixels = (size_t)im->width * (size_t)im->height;
    uint8_t *out = self->texels = mem_array(pixels * (size_t)self->channels, 1);
    self->storage = STORE_U8;
    self->decode = mem_array(256, sizeof *self->decode);
    for (int i = 0; i < 256; i++)
        self->decode[i] = linearise(self, im, (float)i / 255);
    for (size_t p = 0; p < pixels; p++)
        for (int c = 0; c < self->channels; c++) {
            const float v = im->pixels[p * (size_t)im->channels + (size_t)channel[c]];
            *out++ = (uint8_t)(clampf(v, 0, 1) * 255 + 0.5f);
        }
}

// The number of texels that are not finite.
static size_t store_floats(struct bitmap *self, const struct image *im, const int channel[3]) {
    const size_t pixels = (size_t)im->width * (size_t)im->height;
    const size_t count = pixels * (size_t)self->channels;
    float *floats = mem_array(count, sizeof *floats), *out = floats;
    size_t bad = 0;
    for (size_t p = 0; p < pixels; p++) {
        bool good = true;
        for (int c = 0; c < self->channels; c++)
            *out++ = value_of(self, im, im->pixels[p * (size_t)im->channels + (size_t)channel[c]],
                              &good);
        bad += !good;
    }
    uint16_t *halves = mem_array(count, sizeof *halves);
    bool exact = true;
    for (size_t i = 0; i < count && exact; i++)
        exact = float_to_half(floats[i], &halves[i]);
    self->storage = exact ? STORE_HALF : STORE_FLOAT;
    self->texels = exact ? (void *)halves : (void *)floats;
    mem_free(exact ? (void *)floats : (void *)halves);
    return bad;
}

static spectrum texel(const struct bitmap *self, int x, int y) {
    const size_t i = ((size_t)y * (size_t)self->width + (size_t)x) * (size_t)self->channels;
    float v[3];
    if (self->storage == STORE_U8) {
        const uint8_t *p = (const uint8_t *)self->texels + i;
        if (self->channels == 3) // most pictures
            return spectrum_rgb(self->decode[p[0]], self->decode[p[1]], self->decode[p[2]]);
        for (int c = 0; c < self->channels; c++)
            v[c] = self->decode[p[c]];
    } else if (self->storage == STORE_HALF) {
        const uint16_t *p = (const uint16_t *)self->texels + i;
        for (int c = 0; c < self->channels; c++)
            v[c] = half_to_float(p[c]);
    } else {
        const float *p = (const float *)self->texels + i;
        for (int c = 0; c < self->channels; c++)
            v[c] = p[c];
    }
    return self->channels == 1 ? spectrum_grey(v[0]) : spectrum_rgb(v[0], v[1], v[2]);
}

// Mean and range.
static void survey(struct bitmap *self) {
    double sum[3] = {0, 0, 0};
    self->range = (struct texture_range){texel(self, 0, 0), texel(self, 0, 0)};
    for (int y = 0; y < self->height; y++)
        for (int x = 0; x < self->width; x++) {
            const spectrum t = texel(self, x, y);
            for (int c = 0; c < 3; c++)
                sum[c] += t[c];
            texture_range_add(&self->range, t);
        }
    const double n = (double)self->width * self->height;
    self->mean = spectrum_rgb((float)(sum[0] / n), (float)(sum[1] / n), (float)(sum[2] / n));
    if (self->wrap == WRAP_ZERO || self->wrap == WRAP_ONE)
        texture_range_add(&self->range, spectrum_grey(self->wrap == WRAP_ONE));
}

// Once a file.
static void tell_of_bad(const struct object *object, size_t bad, struct arena *arena) {
    static const char told[] = "texels told to be bad";
    struct bitmap *self = object->data;
    if (bad == 0 || arena_find(arena, told, self->filename))
        return;
    arena_keep(arena, told, self->filename, self);
    log_warn_at(object->at, "bitmap: %s has %zu texels that are not finite; they count as zero",
                self->filename, bad);
}

static bool prepare(struct object *object, struct arena *arena) {
    struct bitmap *self = object->data;
    struct image im = {0};
    int channel[3];
    const struct image_bytes *bytes = arena_find(arena, IMAGE_EMBEDDED, self->filename);
    uv_prepare(&self->uv);
    if (!(bytes ? image_read_bytes(self->filename, bytes, &im) : image_read(self->filename, &im)))
        return false;
    const bool ok = choose_channels(self, &im, channel, &self->channels);
    if (ok) {
        self->width = im.width;
        self->height = im.height;
        if (im.bits == 8)
            store_bytes(self, &im, channel);
        else
            tell_of_bad(object, store_floats(self, &im, channel), arena);
        survey(self);
    }
    image_finish(&im);
    return ok;
}

static void finish(void *data) {
    struct bitmap *self = data;
    mem_free(self->texels);
    mem_free(self->decode);
    self->texels = NULL;
    self->decode = NULL;
}

// ---- looking up -----------------------------------------------------------------------------

// Brings a coordinate into the range where the pixel index fits an int. NaN becomes 0.
static float tame(int wrap, float u) {
    if (wrap == WRAP_REPEAT)
        return minf(maxf(u - floorf(u), 0), 1);
    if (wrap == WRAP_MIRROR)
        return minf(maxf(u - 2 * floorf(0.5f * u), 0), 2);
    return minf(maxf(u, -4), 5);
}

// Pixel index inside [0, n), or -1 outside of pictures that end there.
static int wrap_index(int wrap, int i, int n) {
    if (i >= 0 && i < n)
        return i;
    if (wrap == WRAP_REPEAT) {
        i %= n;
        return i < 0 ? i + n : i;
    }
    if (wrap == WRAP_MIRROR) {
        i %= 2 * n;
        i = i < 0 ? i + 2 * n : i;
        return i < n ? i : 2 * n - 1 - i;
    }
    if (wrap == WRAP_CLAMP)
        return i < 0 ? 0 : n - 1;
    return -1;
}

static spectrum fetch(const struct bitmap *self, int x, int y) {
    x = wrap_index(self->wrap, x, self->width);
    y = wrap_index(self->wrap, y, self->height);
    if (x < 0 || y < 0)
        return spectrum_grey(self->wrap == WRAP_ONE);
    return texel(self, x, y);
}

// The four pixels around a point, and where it stands between them.
struct quad {
    spectrum t[2][2]; // [y][x]
    float wx, wy;
};

static size_t bytes_of_texel(const struct bitmap *self) {
    const size_t number = self->storage == STORE_U8 ? 1 : self->storage == STORE_HALF ? 2 : 4;
    return number * (size_t)self->channels;
}

// In pixels, from the middle of the first.
static struct vec2 place_of(const struct bitmap *self, struct vec2 uv) {
    return (struct vec2){tame(self->wrap, uv.x) * (float)self->width - 0.5f,
                         tame(self->wrap, uv.y) * (float)self->height - 0.5f};
}

// Both rows of the four pixels; what lies across an edge of the picture is not sent for.
static void send_for(const void *data, const struct texture_point *at) {
    const struct bitmap *self = data;
    const struct vec2 place = place_of(self, uv_apply(&self->uv, at->uv));
    const int x = (int)clampf(place.x, 0, (float)(self->width - 1));
    const int y = (int)clampf(place.y, 0, (float)(self->height - 1));
    const size_t bytes = bytes_of_texel(self), row = bytes * (size_t)self->width;
    const char *texel = (const char *)self->texels + (size_t)y * row + (size_t)x * bytes;
    __builtin_prefetch(texel);
    if (y + 1 < self->height)
        __builtin_prefetch(texel + row);
}

static struct quad fetch_quad(const struct bitmap *self, struct vec2 uv) {
    const struct vec2 place = place_of(self, uv);
    const float fx = floorf(place.x), fy = floorf(place.y);
    const int ix = (int)fx, iy = (int)fy;
    struct quad q = {.wx = place.x - fx, .wy = place.y - fy};
    if (ix >= 0 && iy >= 0 && ix + 1 < self->width && iy + 1 < self->height) {
        for (int j = 0; j < 2; j++)
            for (int i = 0; i < 2; i++)
                q.t[j][i] = texel(self, ix + i, iy + j);
    } else {
        for (int j = 0; j < 2; j++)
            for (int i = 0; i < 2; i++)
                q.t[j][i] = fetch(self, ix + i, iy + j);
    }
    return q;
}

static spectrum eval(const void *data, const struct texture_point *at) {
    const struct bitmap *self = data;
    const struct vec2 uv = uv_apply(&self->uv, at->uv);
    if (self->filter == FILTER_NEAREST)
        return fetch(self, (int)floorf(tame(self->wrap, uv.x) * (float)self->width),
                     (int)floorf(tame(self->wrap, uv.y) * (float)self->height));
    const struct quad q = fetch_quad(self, uv);
    const spectrum a = (1 - q.wx) * q.t[0][0] + q.wx * q.t[0][1];
    const spectrum b = (1 - q.wx) * q.t[1][0] + q.wx * q.t[1][1];
    return (1 - q.wy) * a + q.wy * b;
}

static struct vec2 gradient(const void *data, const struct texture_point *at) {
    const struct bitmap *self = data;
    if (self->filter == FILTER_NEAREST)
        return (struct vec2){0, 0};
    const struct quad q = fetch_quad(self, uv_apply(&self->uv, at->uv));
    const float t00 = spectrum_luminance(q.t[0][0]), t01 = spectrum_luminance(q.t[0][1]);
    const float t10 = spectrum_luminance(q.t[1][0]), t11 = spectrum_luminance(q.t[1][1]);
    const float dx = lerpf(q.wy, t01 - t00, t11 - t10), dy = lerpf(q.wx, t10 - t00, t11 - t01);
    return uv_gradient(&self->uv,
                       (struct vec2){dx * (float)self->width, dy * (float)self->height});
}

static spectrum mean(const void *data) {
    return ((const struct bitmap *)data)->mean;
}

static struct texture_range range(const void *data, const struct mesh *mesh) {
    (void)mesh;
    return ((const struct bitmap *)data)->range;
}

static void size(const void *data, int *width, int *height) {
    *width = ((const struct bitmap *)data)->width;
    *height = ((const struct bitmap *)data)->height;
}

const struct texture_type texture_bitmap = {
    .entry = {.name = "bitmap", .help = "a picture", .params = params,
              .size = sizeof(struct bitmap)},
    .prepare = prepare, .eval = eval, .send_for = send_for, .gradient = gradient, .mean = mean,
    .range = range, .reads_uv = true, .size = size, .finish = finish,
};
