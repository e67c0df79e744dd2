// SPDX-License-Identifier: Apache-2.0
#include "replay/export.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "image/image.h"

enum { CHANNELS = 3 };

// ---- names --------------------------------------------------------------------------------------

static void name_coefficient(const struct json *basis, uint32_t i, char *name, size_t size) {
    const char *type = json_text(json_get(basis, "type"));
    const char *light = json_text(json_at(json_get(basis, "lights"), i));
    int64_t columns = 0;
    json_read_integer(json_get(basis, "width"), &columns);
    if (light) {
        snprintf(name, size, "%s", light);
    } else if (type && strcmp(type, "sh") == 0) {
        const int l = (int)sqrt((double)i);
        snprintf(name, size, "sh_%d_%d", l, (int)i - l * (l + 1));
    } else if (columns > 0) {
        snprintf(name, size, "%s_%d_%d", type && strcmp(type, "pixels") == 0 ? "cell" : "wavelet",
                 (int)(i / columns), (int)(i % columns));
    } else {
        snprintf(name, size, "coefficient_%u", i);
    }
}

static void name_layer(struct image *im, uint32_t layer, const char *name) {
    for (uint32_t k = 0; k < CHANNELS; k++)
        snprintf(im->channel_names[layer * CHANNELS + k], IMAGE_NAME_SIZE, "%.*s.%c",
                 IMAGE_NAME_SIZE - 3, name, "RGB"[k]);
}

// ---- values -------------------------------------------------------------------------------------

static void fill_coefficient(const struct tensor_block *b, uint32_t coefficient, struct image *im) {
    const struct tensor_data values = tensor_values_of(b);
    float row[ROW_VALUES];
    for (uint64_t i = 0; i < b->pixel_count; i++) {
        if (i % TENSOR_LANES == 0)
            tensor_row(&values, b->coefficients, i / TENSOR_LANES, coefficient, row);
        float *pixel = im->pixels + (size_t)b->pixels[i] * (size_t)im->channels + coefficient * CHANNELS;
        for (uint32_t k = 0; k < CHANNELS; k++)
            pixel[k] = row[k * TENSOR_LANES + i % TENSOR_LANES];
    }
}

static void fill_fixed(const struct tensor *t, uint32_t layer, struct image *im) {
    const size_t plane = (size_t)t->width * t->height;
    for (size_t i = 0; i < plane && t->fixed; i++)
        for (uint32_t k = 0; k < CHANNELS; k++)
            im->pixels[i * (size_t)im->channels + layer * CHANNELS + k] = t->fixed[k * plane + i];
}

static bool is_small(const struct tensor *t, const char *path) {
    const struct json *basis = json_get(t->meta, "basis");
    if (!basis || t->block_count != 1 || t->blocks[0].channels != CHANNELS) {
        log_error("%s: is not a tensor of `relume precompute relight`, whose coefficients are pictures",
                  path);
        return false;
    }
    if (t->blocks[0].coefficients <= EXPORT_MOST)
        return true;
    log_error("%s: has %u coefficients, more than the %d that one EXR file is written with", path,
              t->blocks[0].coefficients, EXPORT_MOST);
    return false;
}

bool export_coefficients(const struct tensor *t, const char *path, const char *output,
                         const char *command, const char *version) {
    struct image im;
    if (!is_small(t, path))
        return false;
    const struct tensor_block *b = &t->blocks[0];
    const uint32_t n = b->coefficients;
    if (!image_init(&im, (int)t->width, (int)t->height, (int)((n + 1) * CHANNELS)))
        return false;
    for (uint32_t i = 0; i < n; i++) {
        char name[256];
        name_coefficient(json_get(t->meta, "basis"), i, name, sizeof name);
        name_layer(&im, i, name);
        fill_coefficient(b, i, &im);
    }
    name_layer(&im, n, "fixed");
    fill_fixed(t, n, &im);
    image_set_text(&im, "relume.command", command);
    image_set_text(&im, "relume.version", version);
    image_set_text(&im, "relume.colourSpace", "linear Rec.709");
    const bool written = image_write_exr(output, &im, NULL);
    image_finish(&im);
    return written;
}
