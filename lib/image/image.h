// SPDX-License-Identifier: Apache-2.0
// Pictures in memory and on disk.
//
// Pixels are float, interleaved: pixels[(y * width + x) * channels + c], y downwards. Channel names
// follow EXR: "R", "albedo.G", "Z". Attributes are strings or numbers that travel in EXR headers.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct image_attribute {
    char name[64];
    char *text;    // NULL: the number
    double number;
};

struct image {
    int width, height, channels;
    float *pixels;               // owned
    char (*channel_names)[64];   // owned
    struct image_attribute *attributes; // owned
    int attribute_count;
    bool srgb_encoded; // 8-bit file in a display encoding: linearise before use as a colour
    int bits;          // per channel in the file: 8, 16, 32
};

bool image_init(struct image *im, int width, int height, int channels); // names R G B A / Y
void image_finish(struct image *im);
void image_set_text(struct image *im, const char *name, const char *text);
void image_set_number(struct image *im, const char *name, double number);
const struct image_attribute *image_find_attribute(const struct image *im, const char *name);
int image_find_channel(const struct image *im, const char *name); // -1: none

// Reads any format: EXR through OpenEXRCore here, everything else through OpenImageIO in a child
// process with limits on memory and time. false after one error message.
bool image_read(const char *path, struct image *im);

struct image_exr_options {
    bool half;                // 16-bit channels; values beyond its range become infinite
    uint64_t *half_overflows; // counts them; may be NULL
};

// Atomic (base/file.h). ZIP compression.
bool image_write_exr(const char *path, const struct image *im,
                     const struct image_exr_options *options);
// 8-bit sRGB PNG from linear RGB in channels 0-2 (1 channel: grey); values are clipped to [0,1].
bool image_write_png(const char *path, const struct image *im);

// The linear Rec.709 picture (3 channels) of an image: channels R G B, or Y, or the first ones;
// srgb_encoded ones are linearised. false: no such channels (message).
bool image_to_rgb(const struct image *im, struct image *rgb);

static inline float srgb_to_linear(float v) {
    return v <= 0.04045f ? v / 12.92f : __builtin_powf((v + 0.055f) / 1.055f, 2.4f);
}

static inline float linear_to_srgb(float v) {
    return v <= 0.0031308f ? 12.92f * v : 1.055f * __builtin_powf(v, 1 / 2.4f) - 0.055f;
}
