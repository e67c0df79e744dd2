// SPDX-License-Identifier: Apache-2.0
// Chunks are made and compressed by several threads but written by one, in order: OpenEXRCore loses
// chunks that two threads write, and still reports success at the end.
#include <inttypes.h>
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

enum {
    BATCH = 32,   // chunks in flight
    ZIP_LEVEL = 2 // of zlib: renderings come out 0.2 to 4 % smaller than at its own 6, in 2/3 of the time
};

// A chunk as it will stand in the file.
struct packed {
    void *data;
    size_t size, capacity;
};

// What a thread makes chunks with.
struct packer {
    exr_encode_pipeline_t pipeline;
    bool started;
    float *rows; // of a chunk, where the image has no pixels
};

struct writer {
    const struct image *im;
    const struct image_exr_options *options;
    exr_context_t context;
    int first_line, lines_per_chunk, chunk_count; // of the part
    int first_chunk;                              // of the batch
    struct packed chunks[BATCH];
    int threads;
    struct packer *packers; // a thread
    bool *identities;       // channels
    atomic_ullong overflows, half_overflows;
    atomic_bool failed;
};

// Numbers that name objects do not survive rounding.
static bool is_identity(const char *channel) {
    return strncmp(channel, "Crypto", 6) == 0 || strcmp(channel, "shape.Y") == 0 ||
           strcmp(channel, "instance.Y") == 0;
}

// Values that are not finite, and finite ones that round to infinity as a half: beyond 65504 + 16,
// half the last step.
static void count_overflows(struct writer *w, const float *values, size_t pixels) {
    const size_t n = (size_t)w->im->channels;
    unsigned long long infinite = 0, half = 0;
    for (size_t i = 0; i < pixels; i++)
        for (size_t c = 0; c < n; c++) {
            const float v = values[i * n + c];
            infinite += !w->identities[c] & !isfinite(v);
            half += !w->identities[c] & (isfinite(v) && fabsf(v) >= 65520.0f);
        }
    atomic_fetch_add(&w->overflows, infinite);
    atomic_fetch_add(&w->half_overflows, half);
}

void image_warn_overflows(uint64_t overflows, uint64_t half_overflows) {
    if (overflows)
        log_warn("%" PRIu64 " values were beyond the range of 32 bits and became infinite", overflows);
    if (half_overflows)
        log_warn("%" PRIu64 " values were beyond the range of half and became infinite", half_overflows);
}

static bool add_channels(const struct writer *w, int part) {
    for (int c = 0; c < w->im->channels; c++)
        if (exr_add_channel(w->context, part, w->im->channel_names[c],
                            w->options->half && !w->identities[c] ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                            EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1) != EXR_ERR_SUCCESS)
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

static bool write_header(struct writer *w) {
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
           exr_set_zip_compression_level(w->context, part, ZIP_LEVEL) == EXR_ERR_SUCCESS &&
           add_channels(w, part) && add_attributes(w->context, part, im) &&
           exr_write_header(w->context) == EXR_ERR_SUCCESS &&
           exr_get_scanlines_per_chunk(w->context, part, &w->lines_per_chunk) == EXR_ERR_SUCCESS &&
           (w->first_line = y, true);
}

// The pixels of the chunk that begins at a row, which the thread may have to make.
static const float *chunk_pixels(struct writer *w, struct packer *p, int row) {
    const struct image *im = w->im;
    const int left = im->height - row, rows = left < w->lines_per_chunk ? left : w->lines_per_chunk;
    const size_t line = (size_t)im->width * (size_t)im->channels;
    const float *pixels = im->pixels ? im->pixels + (size_t)row * line : p->rows;
    if (!im->pixels) {
        if (!p->rows)
            pixels = p->rows = mem_array((size_t)w->lines_per_chunk * line, sizeof *p->rows);
        w->options->rows.make(w->options->rows.self, row, rows, p->rows);
    }
    count_overflows(w, pixels, (size_t)rows * (size_t)im->width);
    return pixels;
}

static bool encode(struct writer *w, struct packer *packer, int row, const float *pixels) {
    const struct image *im = w->im;
    exr_encode_pipeline_t *p = &packer->pipeline;
    exr_chunk_info_t chunk;
    if (exr_write_scanline_chunk_info(w->context, 0, w->first_line + row, &chunk) !=
        EXR_ERR_SUCCESS)
        return false;
    const exr_result_t begun = packer->started
                                   ? exr_encoding_update(w->context, 0, &chunk, p)
                                   : exr_encoding_initialize(w->context, 0, &chunk, p);
    packer->started = true;
    if (begun != EXR_ERR_SUCCESS)
        return false;
    for (int c = 0; c < p->channel_count; c++) {
        exr_coding_channel_info_t *info = &p->channels[c];
        const int channel = image_find_channel(im, info->channel_name); // the library sorted them
        info->encode_from_ptr = (const uint8_t *)(pixels + channel);
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

static void pack_chunk(void *ctx, size_t slot, int worker) {
    struct writer *w = ctx;
    struct packer *packer = &w->packers[worker];
    const int row = (w->first_chunk + (int)slot) * w->lines_per_chunk;
    if (!encode(w, packer, row, chunk_pixels(w, packer, row))) {
        atomic_store(&w->failed, true);
        return;
    }
    // Readers take a chunk of its full size for an uncompressed one; OpenEXRCore 3.1.5 hands out a
    // compressed one where the two sizes are equal.
    const exr_encode_pipeline_t *p = &packer->pipeline;
    const bool packs = p->compressed_bytes < p->packed_bytes;
    struct packed *chunk = &w->chunks[slot];
    chunk->size = packs ? p->compressed_bytes : p->packed_bytes;
    mem_grow(&chunk->data, &chunk->capacity, chunk->size, 1);
    memcpy(chunk->data, packs ? p->compressed_buffer : p->packed_buffer, chunk->size);
}

static bool write_chunks(struct writer *w) {
    for (; w->first_chunk < w->chunk_count; w->first_chunk += BATCH) {
        const int left = w->chunk_count - w->first_chunk, n = left < BATCH ? left : BATCH;
        thread_for(w->threads, (size_t)n, pack_chunk, w);
        for (int i = 0; i < n && !atomic_load(&w->failed); i++) {
            const int y = w->first_line + (w->first_chunk + i) * w->lines_per_chunk;
            if (exr_write_scanline_chunk(w->context, 0, y, w->chunks[i].data, w->chunks[i].size) !=
                EXR_ERR_SUCCESS)
                atomic_store(&w->failed, true);
        }
        if (atomic_load(&w->failed))
            return false;
    }
    return true;
}

static bool write_file(const char *temp, struct writer *w, struct exr_errors *errors) {
    exr_context_initializer_t init = exr_initializer(errors);
    if (exr_start_write(&w->context, temp, EXR_WRITE_FILE_DIRECTLY, &init) != EXR_ERR_SUCCESS)
        return false;
    bool good = write_header(w);
    if (good) {
        w->chunk_count = (w->im->height + w->lines_per_chunk - 1) / w->lines_per_chunk;
        good = write_chunks(w);
    }
    for (int i = 0; i < w->threads; i++)
        if (w->packers[i].started)
            exr_encoding_destroy(w->context, &w->packers[i].pipeline);
    return exr_finish(&w->context) == EXR_ERR_SUCCESS && good;
}

static struct writer *writer_create(const struct image *im, const struct image_exr_options *options) {
    struct writer *w = mem_array(1, sizeof *w);
    w->im = im;
    w->options = options;
    w->threads = options->threads > 0 ? options->threads : thread_default_count();
    w->packers = mem_array((size_t)w->threads, sizeof *w->packers);
    w->identities = mem_array((size_t)im->channels, sizeof *w->identities);
    for (int c = 0; c < im->channels; c++)
        w->identities[c] = is_identity(im->channel_names[c]);
    return w;
}

static void writer_destroy(struct writer *w) {
    for (int i = 0; i < BATCH; i++)
        mem_free(w->chunks[i].data);
    for (int i = 0; i < w->threads; i++)
        mem_free(w->packers[i].rows);
    mem_free(w->packers);
    mem_free(w->identities);
    mem_free(w);
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
    struct writer *w = writer_create(im, options);
    const bool written = write_file(temp, w, &errors);
    if (options->overflows)
        *options->overflows = w->overflows;
    if (options->half_overflows)
        *options->half_overflows = options->half ? w->half_overflows : 0;
    writer_destroy(w);
    if (!written) {
        log_error("%s: cannot be written: %s", path,
                  errors.message[0] ? errors.message : "the library says no more");
        file_discard(temp);
        return false;
    }
    return file_commit(temp, path);
}
