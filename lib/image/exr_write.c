// SPDX-License-Identifier: Apache-2.0
// Chunks are compressed by several threads but written by one, in order: OpenEXRCore loses chunks
// that two threads write, and still reports success at the end.
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "image/exr_core.h"
#include "image/image.h"

enum { BATCH = 32 }; // chunks in flight

struct writer {
    const struct image *im;
    exr_context_t context;
    int first_line, lines_per_chunk, chunk_count; // of the part
    int first_chunk;                              // of the batch
    exr_encode_pipeline_t pipelines[BATCH];
    bool started[BATCH];
    atomic_bool failed;
};

// Numbers that name objects do not survive rounding.
static bool is_identity(const char *channel) {
    return strncmp(channel, "Crypto", 6) == 0 || strcmp(channel, "shape.Y") == 0 ||
           strcmp(channel, "instance.Y") == 0;
}

// Values that are not finite, and finite ones that round to infinity as a half: beyond 65504 + 16,
// half the last step.
static void count_overflows(const struct image *im, const struct image_exr_options *o) {
    const size_t pixels = (size_t)im->width * (size_t)im->height, n = (size_t)im->channels;
    uint64_t infinite = 0, half = 0;
    bool *counts = mem_array(n, sizeof *counts);
    for (size_t c = 0; c < n; c++)
        counts[c] = !is_identity(im->channel_names[c]);
    for (size_t i = 0; i < pixels; i++)
        for (size_t c = 0; c < n; c++) {
            const float v = im->pixels[i * n + c];
            infinite += counts[c] & !isfinite(v);
            half += counts[c] & (isfinite(v) && fabsf(v) >= 65520.0f);
        }
    mem_free(counts);
    if (o->overflows)
        *o->overflows = infinite;
    if (o->half_overflows)
        *o->half_overflows = o->half ? half : 0;
}

static bool add_channels(exr_context_t context, int part, const struct image *im, bool half) {
    for (int c = 0; c < im->channels; c++)
        if (exr_add_channel(context, part, im->channel_names[c],
                            half && !is_identity(im->channel_names[c]) ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC,
                            1, 1) != EXR_ERR_SUCCESS)
            return false;
    return true;
}

// The text that primaries.h describes.
static bool add_chromaticities(exr_context_t context, int part, const struct image_attribute *a) {
    exr_attr_chromaticities_t c;
    return sscanf(a->text, "%f %f %f %f %f %f %f %f", &c.red_x, &c.red_y, &c.green_x, &c.green_y,
                  &c.blue_x, &c.blue_y, &c.white_x, &c.white_y) == 8 &&
           exr_attr_set_chromaticities(context, part, a->name, &c) == EXR_ERR_SUCCESS;
}

static bool add_attributes(exr_context_t context, int part, const struct image *im) {
    for (int i = 0; i < im->attribute_count; i++) {
        const struct image_attribute *a = &im->attributes[i];
        if (strncmp(a->name, "file.", 5) == 0)
            continue;
        if (strcmp(a->name, "chromaticities") == 0 && a->text) {
            if (!add_chromaticities(context, part, a))
                return false;
            continue;
        }
        const exr_result_t added = a->text
                                       ? exr_attr_set_string(context, part, a->name, a->text)
                                       : exr_attr_set_double(context, part, a->name, a->number);
        if (added != EXR_ERR_SUCCESS)
            return false;
    }
    return true;
}

// By fields: whether the corners are structs or unions depends on the version of the library.
static exr_attr_box2i_t make_box(int x, int y, int width, int height) {
    exr_attr_box2i_t box;
    box.min.x = x;
    box.min.y = y;
    box.max.x = x + width - 1;
    box.max.y = y + height - 1;
    return box;
}

static bool write_header(struct writer *w, bool half) {
    const struct image *im = w->im;
    const int x = im->full_width ? im->crop_x : 0, y = im->full_width ? im->crop_y : 0;
    const exr_attr_box2i_t data = make_box(x, y, im->width, im->height);
    const exr_attr_box2i_t display =
        im->full_width ? make_box(0, 0, im->full_width, im->full_height) : data;
    exr_attr_v2f_t centre;
    centre.x = centre.y = 0;
    int part = 0;
    return exr_set_longname_support(w->context, 1) == EXR_ERR_SUCCESS &&
           exr_add_part(w->context, NULL, EXR_STORAGE_SCANLINE, &part) == EXR_ERR_SUCCESS &&
           exr_initialize_required_attr(w->context, part, &display, &data, 1,
                                        &centre, 1,
                                        EXR_LINEORDER_INCREASING_Y,
                                        EXR_COMPRESSION_ZIP) == EXR_ERR_SUCCESS &&
           add_channels(w->context, part, im, half) && add_attributes(w->context, part, im) &&
           exr_write_header(w->context) == EXR_ERR_SUCCESS &&
           exr_get_scanlines_per_chunk(w->context, part, &w->lines_per_chunk) == EXR_ERR_SUCCESS &&
           (w->first_line = y, true);
}

static bool encode_chunk(struct writer *w, int slot) {
    const struct image *im = w->im;
    const int row = (w->first_chunk + slot) * w->lines_per_chunk;
    exr_encode_pipeline_t *p = &w->pipelines[slot];
    exr_chunk_info_t chunk;
    if (exr_write_scanline_chunk_info(w->context, 0, w->first_line + row, &chunk) !=
        EXR_ERR_SUCCESS)
        return false;
    const exr_result_t begun = w->started[slot] ? exr_encoding_update(w->context, 0, &chunk, p)
                                                : exr_encoding_initialize(w->context, 0, &chunk, p);
    w->started[slot] = true;
    if (begun != EXR_ERR_SUCCESS)
        return false;
    for (int c = 0; c < p->channel_count; c++) {
        exr_coding_channel_info_t *info = &p->channels[c];
        const int channel = image_find_channel(im, info->channel_name); // the library sorted them
        info->encode_from_ptr =
            (const uint8_t *)(im->pixels + (size_t)row * im->width * im->channels + channel);
        info->user_bytes_per_element = sizeof(float);
        info->user_data_type = EXR_PIXEL_FLOAT;
        info->user_pixel_stride = im->channels * (int32_t)sizeof(float);
        info->user_line_stride = im->width * info->user_pixel_stride;
    }
    if (exr_encoding_choose_default_routines(w->context, 0, p) != EXR_ERR_SUCCESS)
        return false;
    p->yield_until_ready_fn = NULL;
    p->write_fn = NULL;
    return exr_encoding_run(w->context, 0, p) == EXR_ERR_SUCCESS;
}

static void encode_item(void *ctx, size_t slot, int worker) {
    struct writer *w = ctx;
    (void)worker;
    if (!encode_chunk(w, (int)slot))
        atomic_store(&w->failed, true);
}

static bool write_chunks(struct writer *w, int threads) {
    for (; w->first_chunk < w->chunk_count; w->first_chunk += BATCH) {
        const int left = w->chunk_count - w->first_chunk, n = left < BATCH ? left : BATCH;
        thread_for(threads, (size_t)n, encode_item, w);
        for (int i = 0; i < n && !atomic_load(&w->failed); i++) {
            const int y = w->first_line + (w->first_chunk + i) * w->lines_per_chunk;
            const exr_encode_pipeline_t *p = &w->pipelines[i];
            // Readers take a chunk of its full size for an uncompressed one; OpenEXRCore 3.1.5
            // hands out a compressed one where the two sizes are equal.
            const bool packs = p->compressed_bytes < p->packed_bytes;
            if (exr_write_scanline_chunk(w->context, 0, y,
                                         packs ? p->compressed_buffer : p->packed_buffer,
                                         packs ? p->compressed_bytes : p->packed_bytes) !=
                EXR_ERR_SUCCESS)
                atomic_store(&w->failed, true);
        }
        if (atomic_load(&w->failed))
            return false;
    }
    return true;
}

static bool write_file(const char *temp, const struct image *im, bool half, int threads,
                       struct exr_errors *errors) {
    exr_context_initializer_t init = exr_initializer(errors);
    struct writer *w = mem_array(1, sizeof *w);
    w->im = im;
    if (exr_start_write(&w->context, temp, EXR_WRITE_FILE_DIRECTLY, &init) != EXR_ERR_SUCCESS) {
        mem_free(w);
        return false;
    }
    bool good = write_header(w, half);
    if (good) {
        w->chunk_count = (im->height + w->lines_per_chunk - 1) / w->lines_per_chunk;
        good = write_chunks(w, threads);
    }
    for (int i = 0; i < BATCH; i++)
        if (w->started[i])
            exr_encoding_destroy(w->context, &w->pipelines[i]);
    good = exr_finish(&w->context) == EXR_ERR_SUCCESS && good;
    mem_free(w);
    return good;
}

static bool check_image(const char *path, const struct image *im) {
    if ((double)im->width * im->channels * sizeof(float) > INT32_MAX ||
        im->width > EXR_LARGEST_SIDE || im->height > EXR_LARGEST_SIDE) {
        log_error("%s: cannot be written: %d x %d pixels with %d channels are too many", path,
                  im->width, im->height, im->channels);
        return false;
    }
    for (int c = 0; c < im->channels; c++)
        if (!im->channel_names[c][0] || image_find_channel(im, im->channel_names[c]) != c) {
            log_error("%s: cannot be written: two channels have the name '%s', or it is empty; names "
                      "differ within %d bytes", path, im->channel_names[c], IMAGE_NAME_SIZE - 1);
            return false;
        }
    return true;
}

bool image_write_exr(const char *path, const struct image *im,
                     const struct image_exr_options *options) {
    static const struct image_exr_options standard = {0};
    options = options ? options : &standard;
    char temp[4096];
    struct exr_errors errors = {""};
    if (!check_image(path, im) || !file_temp_name(path, temp, sizeof temp))
        return false;
    if (options->overflows || options->half_overflows)
        count_overflows(im, options);
    if (!write_file(temp, im, options->half, options->threads, &errors)) {
        log_error("%s: cannot be written: %s", path,
                  errors.message[0] ? errors.message : "the library says no more");
        file_discard(temp);
        return false;
    }
    return file_commit(temp, path);
}
