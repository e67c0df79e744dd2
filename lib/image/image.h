// SPDX-License-Identifier: Apache-2.0
// Pictures in memory and on disk.
//
// Pixels are float, interleaved: pixels[(y * width + x) * channels + c], y downwards. Channel names
// follow EXR: "R", "albedo.G", "Z"; a reader puts R G B A of a layer into that order. Attributes
// are strings or numbers that travel in EXR headers; names that begin with "file." describe the
// file an image was read from and are not written.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { IMAGE_NAME_SIZE = 64 }; // of channel and attribute names, with the terminating zero

struct image_attribute {
    char name[IMAGE_NAME_SIZE];
    char *text;    // owned; NULL: the number
    double number;
};

struct image {
    int width, height, channels;
    float *pixels;               // owned; NULL: see struct image_rows
    char (*channel_names)[IMAGE_NAME_SIZE]; // owned
    struct image_attribute *attributes; // owned
    int attribute_count;
    bool srgb_encoded; // 8-bit file in a display encoding: linearise before use as a colour
    int bits;          // per channel in the file: 8, 16, 32
    // The picture that this one is a crop of: its size and where the crop begins in it (EXR display
    // and data window). full_width == 0: not a crop.
    int full_width, full_height, crop_x, crop_y;
};

// All zero pixels; channel names Y, YA, RGB, RGBA or channel0, channel1, ... false after an error
// message: a size below 1 or beyond 2^40 values.
bool image_init(struct image *im, int width, int height, int channels);
// The same in two steps. The first gives names without pixels.
bool image_init_head(struct image *im, int width, int height, int channels);
void image_add_pixels(struct image *im);
void image_finish(struct image *im);
void image_set_text(struct image *im, const char *name, const char *text);
void image_set_number(struct image *im, const char *name, double number);
const struct image_attribute *image_find_attribute(const struct image *im, const char *name);
// Appends black channels without names.
void image_add_channels(struct image *im, int count);
int image_find_channel(const struct image *im, const char *name); // -1: none

// Reads any format: EXR through OpenEXRCore, everything else through OpenImageIO, both in a child
// process with limits on memory and time (decode.h). false after one error message; *im is then
// empty. EXR: the first part, level 0, uint and half converted to float; deep data and subsampled
// channels are refused. DWA compression, which OpenEXRCore lacks, is read through OpenImageIO.
bool image_read(const char *path, struct image *im);

// A picture file that lies in memory: part of another file. Readers of such files keep it in the
// arena under this kind and a name that bitmaps then give for a file name.
#define IMAGE_EMBEDDED "embedded picture"
struct image_bytes {
    const void *data;
    size_t size;
};
// PNG, JPEG and the like, as image_read does; `name` is for messages.
bool image_read_bytes(const char *name, const struct image_bytes *bytes, struct image *im);

// Where pixels come from that never lie in memory as a whole.
struct image_rows {
    // Makes `rows` rows from row y on; called by several threads at once.
    void (*make)(const void *self, int y, int rows, float *pixels);
    const void *self;
};

struct image_exr_options {
    bool half;                // 16-bit channels but for numbers that name objects; values beyond
                              // its range become infinite
    uint64_t *half_overflows; // is set to their number; may be NULL
    uint64_t *overflows;      // to the number of values that no float held; may be NULL
    int threads;              // 0: default
    struct image_rows rows;   // of an image without pixels
};
// Warns of what an options' overflows and half_overflows were set to; says nothing of none.
void image_warn_overflows(uint64_t overflows, uint64_t half_overflows);

// Atomic (base/file.h). ZIP compression. Channel names must differ. options may be NULL.
bool image_write_exr(const char *path, const struct image *im,
                     const struct image_exr_options *options);
// 8-bit sRGB PNG from linear RGB in channels 0-2 (1 or 2 channels: grey); values are clipped to
// [0,1], NaN becomes 0. What is encoded for a display already (srgb_encoded) stays so. Atomic.
bool image_write_png(const char *path, const struct image *im);

// The linear Rec.709 picture (3 channels) of an image: its channels R G B, or Y, or the first ones;
// srgb_encoded ones are linearised. false: out of range sizes only.
bool image_to_rgb(const struct image *im, struct image *rgb);
// The same of one layer ("albedo": albedo.R, ...; "Z": that channel; "": the unnamed one). X Y Z of
// a layer are taken as they are. false after an error message that names `path`: no such layer.
bool image_layer_to_rgb(const struct image *im, const char *layer, const char *path,
                        struct image *rgb);
// Means of factor x factor boxes; the last ones are smaller where factor does not divide the size.
bool image_downsample(const struct image *im, int factor, struct image *out);

// Luminance of linear Rec.709.
static inline float rgb_luminance(const float *rgb) {
    return 0.212671f * rgb[0] + 0.715160f * rgb[1] + 0.072169f * rgb[2];
}

static inline float srgb_to_linear(float v) {
    return v <= 0.04045f ? v / 12.92f : __builtin_powf((v + 0.055f) / 1.055f, 2.4f);
}

static inline float linear_to_srgb(float v) {
    return v <= 0.0031308f ? 12.92f * v : 1.055f * __builtin_powf(v, 1 / 2.4f) - 0.055f;
}
