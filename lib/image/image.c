// SPDX-License-Identifier: Apache-2.0
#include "image/primaries.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "image/decode.h"
#include "image/oiio.h"

bool image_init_head(struct image *im, int width, int height, int channels) {
    static const char *const names[5][4] = {{0}, {"Y"}, {"Y", "A"}, {"R", "G", "B"},
                                            {"R", "G", "B", "A"}};
    *im = (struct image){0};
    if (width < 1 || height < 1 || channels < 1 ||
        (double)width * height * channels > 0x1p40) {
        log_error("a picture of %d x %d pixels and %d channels cannot be made", width, height,
                  channels);
        return false;
    }
    im->width = width;
    im->height = height;
    im->channels = channels;
    im->bits = 32;
    im->channel_names = mem_array((size_t)channels, sizeof *im->channel_names);
    for (int c = 0; c < channels; c++)
        if (channels <= 4)
            snprintf(im->channel_names[c], IMAGE_NAME_SIZE, "%s", names[channels][c]);
        else
            snprintf(im->channel_names[c], IMAGE_NAME_SIZE, "channel%d", c);
    return true;
}

void image_add_pixels(struct image *im) {
    im->pixels = mem_array((size_t)im->width * (size_t)im->height,
                           (size_t)im->channels * sizeof *im->pixels);
}

bool image_init(struct image *im, int width, int height, int channels) {
    const bool made = image_init_head(im, width, height, channels);
    if (made)
        image_add_pixels(im);
    return made;
}

void image_finish(struct image *im) {
    for (int i = 0; i < im->attribute_count; i++)
        mem_free(im->attributes[i].text);
    mem_free(im->attributes);
    mem_free(im->channel_names);
    mem_free(im->pixels);
    *im = (struct image){0};
}

const struct image_attribute *image_find_attribute(const struct image *im, const char *name) {
    for (int i = 0; i < im->attribute_count; i++)
        if (strcmp(im->attributes[i].name, name) == 0)
            return &im->attributes[i];
    return NULL;
}

// The attribute of that name, emptied; a new one if there is none.
static struct image_attribute *attribute_for(struct image *im, const char *name) {
    struct image_attribute *a = (struct image_attribute *)image_find_attribute(im, name);
    if (a) {
        mem_free(a->text);
        a->text = NULL;
        return a;
    }
    struct image_attribute *grown = mem_array((size_t)im->attribute_count + 1, sizeof *grown);
    if (im->attribute_count)
        memcpy(grown, im->attributes, (size_t)im->attribute_count * sizeof *grown);
    mem_free(im->attributes);
    im->attributes = grown;
    a = &im->attributes[im->attribute_count++];
    snprintf(a->name, sizeof a->name, "%s", name);
    return a;
}

void image_add_channels(struct image *im, int count) {
    const size_t pixels = (size_t)im->width * (size_t)im->height;
    const size_t old = (size_t)im->channels, new = old + (size_t)count;
    float *values = mem_array(pixels * new, sizeof *values);
    void *names = mem_array(new, sizeof *im->channel_names);
    for (size_t i = 0; i < pixels; i++)
        memcpy(values + i * new, im->pixels + i * old, old * sizeof *values);
    memcpy(names, im->channel_names, old * sizeof *im->channel_names);
    mem_free(im->pixels);
    mem_free(im->channel_names);
    im->pixels = values;
    im->channel_names = names;
    im->channels = (int)new;
}

void image_set_text(struct image *im, const char *name, const char *text) {
    const size_t n = strlen(text) + 1;
    char *copy = mem_array(n, 1);
    memcpy(copy, text, n);
    attribute_for(im, name)->text = copy;
}

void image_set_number(struct image *im, const char *name, double number) {
    attribute_for(im, name)->number = number;
}

int image_find_channel(const struct image *im, const char *name) {
    for (int c = 0; c < im->channels; c++)
        if (strcmp(im->channel_names[c], name) == 0)
            return c;
    return -1;
}

static bool is_exr(const char *path) {
    static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char head[4] = {0};
    char extension[8];
    file_extension(path, extension, sizeof extension);
    FILE *f = fopen(path, "rb");
    const bool read = f && fread(head, 1, sizeof head, f) == sizeof head;
    if (f)
        fclose(f);
    return strcmp(extension, "exr") == 0 || (read && memcmp(head, magic, sizeof magic) == 0);
}

bool image_read(const char *path, struct image *im) {
    *im = (struct image){0};
    const bool exr = is_exr(path);
    if (!exr && file_exists(path) && !oiio_load())
        return false;
    return image_decode_in_child(path, exr ? exr_decode : oiio_decode, exr ? oiio_decode : NULL, im);
}

bool image_read_bytes(const char *name, const struct image_bytes *bytes, struct image *im) {
    *im = (struct image){0};
    return oiio_load() &&
           image_decode_bytes_in_child(name, bytes->data, bytes->size, oiio_decode, im);
}

// Finds the channels of a layer that make its colour; false if it has none.
static bool find_rgb(const struct image *im, const char *layer, int channel[3]) {
    static const char *const sets[3][3] = {{"R", "G", "B"}, {"X", "Y", "Z"}, {"Y", "Y", "Y"}};
    for (int s = 0; s < 3; s++) {
        bool all = true;
        for (int i = 0; i < 3 && all; i++) {
            char name[2 * IMAGE_NAME_SIZE];
            snprintf(name, sizeof name, "%s%s%s", layer, layer[0] ? "." : "", sets[s][i]);
            channel[i] = image_find_channel(im, name);
            all = channel[i] >= 0;
        }
        if (all)
            return true;
    }
    channel[0] = channel[1] = channel[2] = image_find_channel(im, layer); // as "Z"
    return channel[0] >= 0;
}

static bool gather_rgb(const struct image *im, const int channel[3], struct image *rgb) {
    if (!image_init(rgb, im->width, im->height, 3))
        return false;
    rgb->full_width = im->full_width;
    rgb->full_height = im->full_height;
    rgb->crop_x = im->crop_x;
    rgb->crop_y = im->crop_y;
    const size_t count = (size_t)im->width * (size_t)im->height;
    for (size_t p = 0; p < count; p++)
        for (int i = 0; i < 3; i++) {
            const float v = im->pixels[p * (size_t)im->channels + (size_t)channel[i]];
            rgb->pixels[3 * p + (size_t)i] = im->srgb_encoded ? srgb_to_linear(v) : v;
        }
    return true;
}

bool image_to_rgb(const struct image *im, struct image *rgb) {
    int channel[3];
    *rgb = (struct image){0};
    if (!find_rgb(im, "", channel))
        for (int i = 0; i < 3; i++)
            channel[i] = im->channels >= 3 ? i : 0;
    const bool gathered = gather_rgb(im, channel, rgb);
    if (gathered)
        image_rgb_to_rec709(rgb, im);
    return gathered;
}

bool image_layer_to_rgb(const struct image *im, const char *layer, const char *path,
                        struct image *rgb) {
    int channel[3];
    *rgb = (struct image){0};
    if (!layer[0])
        return image_to_rgb(im, rgb);
    if (find_rgb(im, layer, channel)) {
        const bool gathered = gather_rgb(im, channel, rgb);
        const char *red = im->channel_names[channel[0]];
        if (gathered && red[strlen(red) - 1] == 'R') // and not X Y Z
            image_rgb_to_rec709(rgb, im);
        return gathered;
    }
    log_error("%s: has no layer '%s' (channels R G B, X Y Z or Y of it, or a channel of that name)",
              path, layer);
    return false;
}

bool image_downsample(const struct image *im, int factor, struct image *out) {
    const int width = (im->width + factor - 1) / factor, height = (im->height + factor - 1) / factor;
    if (!image_init(out, width, height, im->channels))
        return false;
    memcpy(out->channel_names, im->channel_names, (size_t)im->channels * sizeof *im->channel_names);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < im->channels; c++) {
                double sum = 0;
                int n = 0;
                for (int v = y * factor; v < (y + 1) * factor && v < im->height; v++)
                    for (int u = x * factor; u < (x + 1) * factor && u < im->width; u++, n++)
                        sum += im->pixels[((size_t)v * im->width + u) * im->channels + c];
                out->pixels[((size_t)y * width + x) * im->channels + c] = (float)(sum / n);
            }
    return true;
}
