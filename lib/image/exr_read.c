// SPDX-License-Identifier: Apache-2.0
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/decode.h"
#include "image/exr_core.h"

// Of the context that this thread opened last. Asking a context for its user data waits for a lock that
// OpenEXRCore 3.1 may hold when it tells of an error, as when the disk is full, and would wait for ever.
static _Thread_local struct exr_errors *kept;

static void keep_error(exr_const_context_t context, exr_result_t code, const char *message) {
    (void)context;
    if (kept && !kept->message[0])
        snprintf(kept->message, sizeof kept->message, "%s (%s)", message,
                 exr_get_error_code_as_string(code));
}

static void *allocate(size_t size) {
    return size <= (size_t)1 << 30 ? malloc(size) : NULL;
}

exr_context_initializer_t exr_initializer(struct exr_errors *errors) {
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = keep_error;
    init.alloc_fn = allocate;
    init.free_fn = free;
    kept = errors;
    init.max_image_width = init.max_image_height = EXR_LARGEST_SIDE;
    init.max_tile_width = init.max_tile_height = EXR_LARGEST_SIDE;
    return init;
}

// One part of a file while it is read.
struct reader {
    struct decoder_input *in;
    exr_context_t context;
    const exr_attr_chlist_t *channels;
    exr_attr_box2i_t window; // data window
    int *order;              // place in the image of each channel of the file
    struct image *im;
    exr_decode_pipeline_t pipeline;
    bool started;            // the pipeline was initialised
};

static const char *compression_name(exr_compression_t c) {
    static const char *const names[] = {"none", "rle", "zips", "zip", "piz",
                                        "pxr24", "b44", "b44a", "dwaa", "dwab"};
    return (size_t)c < sizeof names / sizeof *names ? names[c] : "unknown";
}

static const char *storage_name(exr_storage_t s) {
    static const char *const names[] = {"scanline", "tiled", "deep scanline", "deep tiled"};
    return (size_t)s < sizeof names / sizeof *names ? names[s] : "unknown";
}

// Refuses what this reader does not handle, in words.
static bool check_part(struct reader *r, exr_storage_t storage) {
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return decoder_fail(r->in, "is %s; only flat scanline and tiled data can be read",
                            storage_name(storage));
    for (int c = 0; c < r->channels->num_channels; c++) {
        const exr_attr_chlist_entry_t *e = &r->channels->entries[c];
        if (e->x_sampling != 1 || e->y_sampling != 1)
            return decoder_fail(r->in,
                                "channel %.63s is subsampled (%d x %d); every channel must have a "
                                "value in each pixel",
                                e->name.str, e->x_sampling, e->y_sampling);
        if (e->name.length >= IMAGE_NAME_SIZE)
            return decoder_fail(r->in, "channel %.63s... has a name of more than %d characters",
                                e->name.str, IMAGE_NAME_SIZE - 1);
    }
    return true;
}

struct channel_key {
    char layer[IMAGE_NAME_SIZE];
    int rank, index;
};

static int compare_keys(const void *a, const void *b) {
    const struct channel_key *p = a, *q = b;
    const int layer = strcmp(p->layer, q->layer);
    if (layer != 0)
        return layer;
    return p->rank != q->rank ? p->rank - q->rank : p->index - q->index;
}

// EXR sorts channels by name; here the unnamed layer comes first, and R G B A in that order.
static void choose_order(struct reader *r) {
    static const char colours[] = "RGBA";
    const size_t n = (size_t)r->channels->num_channels;
    struct channel_key *keys = mem_array(n, sizeof *keys);
    r->order = mem_array(n, sizeof *r->order);
    for (size_t c = 0; c < n; c++) {
        const char *name = r->channels->entries[c].name.str, *dot = strrchr(name, '.');
        const char *leaf = dot ? dot + 1 : name;
        const char *found = leaf[0] && !leaf[1] ? strchr(colours, leaf[0]) : NULL;
        keys[c] = (struct channel_key){.rank = found ? (int)(found - colours) : 4, .index = (int)c};
        snprintf(keys[c].layer, IMAGE_NAME_SIZE, "%.*s", dot ? (int)(dot - name) : 0, name);
    }
    qsort(keys, n, sizeof *keys, compare_keys);
    for (size_t i = 0; i < n; i++)
        r->order[keys[i].index] = (int)i;
    mem_free(keys);
}

// Remembers where the data window lies in the display window when they differ.
static void note_crop(struct reader *r) {
    const exr_attr_box2i_t w = r->window;
    exr_attr_box2i_t d;
    if (exr_get_display_window(r->context, 0, &d) != EXR_ERR_SUCCESS ||
        memcmp(&d, &w, sizeof d) == 0)
        return;
    const int64_t width = (int64_t)d.max.x - d.min.x + 1, height = (int64_t)d.max.y - d.min.y + 1;
    const int64_t x = (int64_t)w.min.x - d.min.x, y = (int64_t)w.min.y - d.min.y;
    if (width < 1 || height < 1 || width > EXR_LARGEST_SIDE || height > EXR_LARGEST_SIDE ||
        llabs(x) > EXR_LARGEST_SIDE || llabs(y) > EXR_LARGEST_SIDE)
        return; // a nonsensical window loses nothing but the position
    r->im->full_width = (int)width;
    r->im->full_height = (int)height;
    r->im->crop_x = (int)x;
    r->im->crop_y = (int)y;
}

static bool start_image(struct reader *r) {
    const exr_attr_box2i_t w = r->window;
    const int n = r->channels->num_channels;
    if (n < 1)
        return decoder_fail(r->in, "has no channels");
    if (((double)w.max.x - w.min.x + 1) * n * sizeof(float) > INT32_MAX)
        return decoder_fail(r->in, "has lines of more than 2 GiB");
    if (!decoder_init_image(r->in, r->im, (int64_t)w.max.x - w.min.x + 1,
                            (int64_t)w.max.y - w.min.y + 1, n))
        return false;
    choose_order(r);
    r->im->bits = 16;
    for (int c = 0; c < n; c++) {
        const exr_attr_chlist_entry_t *e = &r->channels->entries[c];
        snprintf(r->im->channel_names[r->order[c]], IMAGE_NAME_SIZE, "%s", e->name.str);
        if (e->pixel_type != EXR_PIXEL_HALF)
            r->im->bits = 32;
    }
    note_crop(r);
    return true;
}

// Decodes a chunk into the image with its upper left corner at pixel (x, y).
static bool decode_chunk(struct reader *r, const exr_chunk_info_t *chunk, int64_t x, int64_t y) {
    struct image *im = r->im;
    if (x < 0 || y < 0 || x + chunk->width > im->width || y + chunk->height > im->height ||
        chunk->unpacked_size > (uint64_t)1 << 30)
        return false;
    exr_decode_pipeline_t *p = &r->pipeline;
    const exr_result_t begun = r->started ? exr_decoding_update(r->context, 0, chunk, p)
                                          : exr_decoding_initialize(r->context, 0, chunk, p);
    r->started = true;
    if (begun != EXR_ERR_SUCCESS)
        return false;
    const size_t stride = (size_t)im->channels * sizeof(float);
    float *corner = im->pixels + ((size_t)y * im->width + (size_t)x) * im->channels;
    for (int c = 0; c < p->channel_count; c++) {
        exr_coding_channel_info_t *info = &p->channels[c];
        info->decode_to_ptr = (uint8_t *)(corner + r->order[c]);
        info->user_bytes_per_element = sizeof(float);
        info->user_data_type = EXR_PIXEL_FLOAT;
        info->user_pixel_stride = (int32_t)stride;
        info->user_line_stride = (int32_t)(stride * (size_t)im->width);
    }
    if (exr_decoding_choose_default_routines(r->context, 0, p) != EXR_ERR_SUCCESS)
        return false;
    const exr_result_t decoded = exr_decoding_run(r->context, 0, p);
    r->in->unsupported = decoded == EXR_ERR_FEATURE_NOT_IMPLEMENTED; // DWA before version 3.4
    return decoded == EXR_ERR_SUCCESS;
}

static bool damaged(struct reader *r, const char *what, int64_t x, int64_t y,
                    const struct exr_errors *errors) {
    return decoder_fail(r->in, "%s at %lld, %lld is missing or damaged%s%s", what, (long long)x,
                        (long long)y, errors->message[0] ? ": " : "", errors->message);
}

static bool read_scanlines(struct reader *r, const struct exr_errors *errors) {
    int32_t lines = 0;
    if (exr_get_scanlines_per_chunk(r->context, 0, &lines) != EXR_ERR_SUCCESS || lines < 1)
        return decoder_fail(r->in, "%s", errors->message);
    for (int64_t y = r->window.min.y; y <= r->window.max.y; y += lines) {
        exr_chunk_info_t chunk;
        if (exr_read_scanline_chunk_info(r->context, 0, (int)y, &chunk) != EXR_ERR_SUCCESS ||
            !decode_chunk(r, &chunk, 0, y - r->window.min.y))
            return damaged(r, "the block of lines", r->window.min.x, y, errors);
    }
    return true;
}

static bool read_tiles(struct reader *r, const struct exr_errors *errors) {
    int32_t tw = 0, th = 0;
    if (exr_get_tile_sizes(r->context, 0, 0, 0, &tw, &th) != EXR_ERR_SUCCESS || tw < 1 || th < 1)
        return decoder_fail(r->in, "%s", errors->message);
    for (int ty = 0; (int64_t)ty * th < r->im->height; ty++)
        for (int tx = 0; (int64_t)tx * tw < r->im->width; tx++) {
            exr_chunk_info_t chunk;
            if (exr_read_tile_chunk_info(r->context, 0, tx, ty, 0, 0, &chunk) != EXR_ERR_SUCCESS ||
                !decode_chunk(r, &chunk, (int64_t)tx * tw, (int64_t)ty * th))
                return damaged(r, "the tile", tx, ty, errors);
        }
    return true;
}

// Attributes that say how a file is laid out are the file's, not the picture's.
static void attribute_key(const char *name, char key[IMAGE_NAME_SIZE]) {
    static const char *const layout[] = {"type", "name", "version", "chunkCount", "pixelAspectRatio",
                                         "screenWindowWidth", "dwaCompressionLevel", NULL};
    snprintf(key, IMAGE_NAME_SIZE, "%s", name);
    for (int i = 0; layout[i]; i++)
        if (strcmp(name, layout[i]) == 0)
            snprintf(key, IMAGE_NAME_SIZE, "file.%s", layout[i]);
}

static void read_chromaticities(struct reader *r, const exr_attribute_t *a) {
    const exr_attr_chromaticities_t *c = a->chromaticities;
    char text[256];
    snprintf(text, sizeof text, "%g %g %g %g %g %g %g %g", (double)c->red_x, (double)c->red_y,
             (double)c->green_x, (double)c->green_y, (double)c->blue_x, (double)c->blue_y,
             (double)c->white_x, (double)c->white_y);
    image_set_text(r->im, a->name, text);
}

// Strings, numbers and primaries; other types are of no use here.
static void read_attributes(struct reader *r) {
    int32_t n = 0;
    exr_get_attribute_count(r->context, 0, &n);
    for (int32_t i = 0; i < n && i < 1024; i++) {
        const exr_attribute_t *a = NULL;
        if (exr_get_attribute_by_index(r->context, 0, EXR_ATTR_LIST_FILE_ORDER, i, &a) !=
                EXR_ERR_SUCCESS ||
            strlen(a->name) >= IMAGE_NAME_SIZE)
            continue;
        char key[IMAGE_NAME_SIZE];
        attribute_key(a->name, key);
        if (a->type == EXR_ATTR_STRING && a->string->length < 1 << 20)
            image_set_text(r->im, key, a->string->str ? a->string->str : "");
        else if (a->type == EXR_ATTR_CHROMATICITIES)
            read_chromaticities(r, a);
        else if (a->type == EXR_ATTR_DOUBLE || a->type == EXR_ATTR_FLOAT || a->type == EXR_ATTR_INT)
            image_set_number(r->im, key, a->type == EXR_ATTR_DOUBLE  ? a->d
                                             : a->type == EXR_ATTR_FLOAT ? (double)a->f
                                                                         : a->i);
    }
}

// "file.part 1": its name, storage, size and channels, for people.
static void describe_part(struct reader *r, int part) {
    char text[4096], key[IMAGE_NAME_SIZE];
    const char *name = NULL;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_compression_t compression = EXR_COMPRESSION_LAST_TYPE;
    exr_attr_box2i_t w = {0};
    const exr_attr_chlist_t *list = NULL;
    exr_get_name(r->context, part, &name);
    exr_get_storage(r->context, part, &storage);
    exr_get_compression(r->context, part, &compression);
    exr_get_data_window(r->context, part, &w);
    exr_get_channels(r->context, part, &list);
    size_t used = (size_t)snprintf(text, sizeof text, "%.200s%s%s, %s, %lld x %lld:",
                                   name ? name : "", name ? ", " : "", storage_name(storage),
                                   compression_name(compression),
                                   (long long)w.max.x - w.min.x + 1,
                                   (long long)w.max.y - w.min.y + 1);
    static const char *const types[] = {"uint", "half", "float"};
    for (int c = 0; list && c < list->num_channels && used < sizeof text; c++) {
        const exr_attr_chlist_entry_t *e = &list->entries[c];
        used += (size_t)snprintf(text + used, sizeof text - used, " %.63s (%s)", e->name.str,
                                 (size_t)e->pixel_type < 3 ? types[e->pixel_type] : "unknown");
    }
    snprintf(key, sizeof key, "file.part %d", part + 1);
    image_set_text(r->im, key, text);
}

static bool read_part(struct reader *r, const struct exr_errors *errors) {
    exr_storage_t storage;
    if (exr_get_storage(r->context, 0, &storage) != EXR_ERR_SUCCESS ||
        exr_get_channels(r->context, 0, &r->channels) != EXR_ERR_SUCCESS ||
        exr_get_data_window(r->context, 0, &r->window) != EXR_ERR_SUCCESS)
        return decoder_fail(r->in, "the header is damaged: %s", errors->message);
    if (!check_part(r, storage) || !start_image(r))
        return false;
    const bool tiled = storage == EXR_STORAGE_TILED;
    if (!(tiled ? read_tiles(r, errors) : read_scanlines(r, errors)))
        return false;
    int parts = 1;
    exr_get_count(r->context, &parts);
    read_attributes(r);
    for (int part = 0; part < parts && part < 256; part++)
        describe_part(r, part);
    return true;
}

bool exr_decode(struct decoder_input *in, struct image *im) {
    struct exr_errors errors = {""};
    struct reader r = {.in = in, .im = im};
    exr_context_initializer_t init = exr_initializer(&errors);
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    if (exr_start_read(&r.context, in->path, &init) != EXR_ERR_SUCCESS)
        return decoder_fail(in, "it is not a sound OpenEXR file: %s", errors.message);
    const bool good = read_part(&r, &errors);
    if (r.started)
        exr_decoding_destroy(r.context, &r.pipeline);
    exr_finish(&r.context);
    mem_free(r.order);
    if (!good)
        image_finish(im);
    return good;
}
