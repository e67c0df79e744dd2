// SPDX-License-Identifier: Apache-2.0
// Decoders of foreign picture formats, and the child process they run in.
//
// The decoding libraries are not ours and read files that anybody may have made: a crash, an
// endless loop or a huge allocation in them must end as one error message. So a decoder runs in a
// forked child and hands the picture back through a pipe. Limits grow with the file, so that a
// small file can claim neither much memory nor much time.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/image.h"

struct decoder_input {
    const char *path;
    const char *part; // of a file with several, by name; NULL: the first
    const void *data; // the file's bytes where they are in memory already; else NULL
    uint64_t file_size;
    char message[4096]; // why it failed, without the file's name
    bool unsupported;  // sound as far as it was read, but this decoder lacks a part it needs
    bool absent;       // sound, but without what was asked for
};

// Fills *im, or writes a message and returns false. Must not use log_error (it runs in the child).
typedef bool (*image_decoder)(struct decoder_input *in, struct image *im);

bool exr_decode(struct decoder_input *in, struct image *im);
bool oiio_decode(struct decoder_input *in, struct image *im);
// Voxels as a picture of height times depth lines; attributes: depth, origin (index of the first
// voxel) and indexToWorld (16 numbers of a matrix for columns, row by row).
bool oiio_decode_voxels(struct decoder_input *in, struct image *im);
// What a display is sent of a picture; in->data is a struct display_view (display.h).
bool oiio_display(struct decoder_input *in, struct image *im);

// Most bytes of pixels that a file of this size may hold: 768 MiB + 64 times its size.
uint64_t decoder_pixel_limit(uint64_t file_size);
// image_init for a decoder: checks the size first.
bool decoder_init_image(struct decoder_input *in, struct image *im, int64_t width, int64_t height,
                        int64_t channels);
bool decoder_fail(struct decoder_input *in, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Runs the decoder in a child, and `fallback` (may be NULL) in another where the first finds the
// file unsupported. false after one error message that names the file.
bool image_decode_in_child(const char *path, image_decoder decode, image_decoder fallback,
                           struct image *im);
// The same of bytes in memory.
bool image_decode_bytes_in_child(const char *name, const void *data, size_t size,
                                 image_decoder decode, struct image *im);
// The same for a part of a file.
bool image_decode_part_in_child(const char *path, const char *part, image_decoder decode,
                                struct image *im);
