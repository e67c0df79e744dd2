// SPDX-License-Identifier: Apache-2.0
#include "replay/relight.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "curve/largest.h"
#include "curve/wavelet.h"
#include "image/image.h"
#include "math/directions.h"
#include "replay/light_factor.h"

enum { MOST_SH = 121, FINE = 4096 };

// What the tensor's coefficients are of.
struct basis {
    enum { LIGHTS, CELLS, HARMONICS } kind;
    bool transformed;
    enum wavelet wavelet;
    int width, height, order;
    const struct json *lights;
};

static bool read_basis(const struct tensor *t, const char *path, struct basis *b) {
    const struct json *j = json_get(t->meta, "basis");
    const char *type = json_text(json_get(j, "type"));
    const uint32_t count = t->block_count == 1 ? t->blocks[0].coefficients : 0;
    int64_t w = 0, h = 0, order = -1;
    *b = (struct basis){0};
    json_read_integer(json_get(j, "width"), &w);
    json_read_integer(json_get(j, "height"), &h);
    json_read_integer(json_get(j, "order"), &order);
    bool sound = false;
    if (type && strcmp(type, "lights") == 0) {
        b->lights = json_get(j, "lights");
        sound = json_count(b->lights) == count;
    } else if (type && strcmp(type, "sh") == 0) {
        b->kind = HARMONICS;
        sound = order >= 0 && order <= 10 && (order + 1) * (order + 1) == count;
    } else if (type) {
        b->kind = CELLS;
        b->transformed = strcmp(type, "pixels") != 0;
        b->wavelet = strcmp(type, "daub4") == 0 ? WAVELET_DAUB4 : WAVELET_HAAR;
        sound = (strcmp(type, "pixels") == 0 || strcmp(type, "haar") == 0 ||
                 strcmp(type, "daub4") == 0) &&
                w > 0 && h > 0 && w <= 1 << 16 && h <= 1 << 16 && w * h == count &&
                (!b->transformed || (wavelet_fits((size_t)w) && wavelet_fits((size_t)h)));
    }
    b->width = (int)w;
    b->height = (int)h;
    b->order = (int)order;
    if (!sound)
        log_error("%s: is not a tensor of `relume precompute relight`", path);
    return sound;
}

// ---- environments -------------------------------------------------------------------------------

// Means of the picture over cells, weighted by solid angle: out[channel][cell]. Column shares that
// the rotation cuts are split.
static void resample(const struct image *im, double rotate, int w, int h, double *out) {
    const int down = 4, across = im->width < FINE / down ? FINE / im->width : down; // parts of a texel
    const double shift = rotate / 360;
    double *weight = mem_array((size_t)w * (size_t)h, sizeof *weight);
    for (int y = 0; y < im->height * down; y++) {
        const double area = latlong_solid_angle(y, im->width * across, im->height * down);
        const int row = (int)((y + 0.5) / (im->height * down) * h);
        for (int x = 0; x < im->width * across; x++) {
            // The column grows from +z towards -x: turning towards +x moves it back.
            double place = (x + 0.5) / (im->width * across) - shift;
            place -= floor(place);
            const int column = (int)(place * w) < w ? (int)(place * w) : w - 1;
            const float *p = im->pixels + 3 * ((size_t)(y / down) * (size_t)im->width +
                                               (size_t)(x / across));
            const size_t cell = (size_t)row * (size_t)w + (size_t)column;
            for (size_t k = 0; k < 3; k++)
                out[k * (size_t)w * (size_t)h + cell] += area * (double)p[k];
            weight[cell] += area;
        }
    }
    for (size_t i = 0; i < (size_t)w * (size_t)h; i++)
        for (size_t k = 0; k < 3; k++)
            out[k * (size_t)w * (size_t)h + i] /= weight[i] > 0 ? weight[i] : 1;
    mem_free(weight);
}

static void harmonics_of(const struct image *im, double rotate, int order, float *weights) {
    const int count = (order + 1) * (order + 1);
    double *sum = mem_array((size_t)count * 3, sizeof *sum);
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++) {
            double d[3], sh[MOST_SH];
            const float *p = im->pixels + 3 * ((size_t)y * (size_t)im->width + (size_t)x);
            latlong_direction(x + 0.5 - rotate / 360 * im->width, y + 0.5, im->width, im->height, d);
            spherical_harmonics(d, order, sh);
            for (int i = 0; i < count; i++)
                for (int k = 0; k < 3; k++)
                    sum[3 * i + k] += sh[i] * (double)p[k] *
                                      latlong_solid_angle(y, im->width, im->height);
        }
    for (int i = 0; i < 3 * count; i++)
        weights[i] = (float)sum[i];
    mem_free(sum);
}

// A picture of an environment as the renderer reads one.
static bool read_environment(const char *path, struct image *rgb) {
    struct image file;
    if (!image_read(path, &file))
        return false;
    const bool good = image_to_rgb(&file, rgb);
    image_finish(&file);
    const size_t n = good ? 3 * (size_t)rgb->width * (size_t)rgb->height : 0;
    for (size_t i = 0; i < n; i++)
        if (!(rgb->pixels[i] >= 0 && rgb->pixels[i] < INFINITY))
            rgb->pixels[i] = 0;
    return good;
}

static void cells_of(const struct basis *b, const float *weights, struct image *rgb) {
    const size_t w = (size_t)b->width, h = (size_t)b->height;
    double *plane = mem_array(w * h, sizeof *plane), *scratch = mem_array(2 * (w + h), sizeof *scratch);
    for (size_t k = 0; k < 3; k++) {
        for (size_t i = 0; i < w * h; i++)
            plane[i] = (double)weights[3 * i + k];
        if (b->transformed)
            wavelet_inverse_matrix(b->wavelet, plane, h, w, scratch);
        for (size_t i = 0; i < w * h; i++)
            rgb->pixels[3 * i + k] = (float)plane[i];
    }
    mem_free(plane);
    mem_free(scratch);
}

static void radiance_of_harmonics(const struct basis *b, const float *weights, struct image *rgb) {
    const int count = (b->order + 1) * (b->order + 1);
    for (int y = 0; y < rgb->height; y++)
        for (int x = 0; x < rgb->width; x++) {
            double d[3], sh[MOST_SH], sum[3] = {0};
            latlong_direction(x + 0.5, y + 0.5, rgb->width, rgb->height, d);
            spherical_harmonics(d, b->order, sh);
            for (int i = 0; i < count; i++)
                for (int k = 0; k < 3; k++)
                    sum[k] += sh[i] * (double)weights[3 * i + k];
            for (int k = 0; k < 3; k++)
                rgb->pixels[3 * ((size_t)y * (size_t)rgb->width + (size_t)x) + (size_t)k] = (float)sum[k];
        }
}

// The scene's own environment, as the tensor has it.
static bool own_environment(const struct basis *b, const float *weights, struct image *rgb) {
    const bool cells = b->kind == CELLS;
    if (!image_init(rgb, cells ? b->width : FINE / 8, cells ? b->height : FINE / 16, 3))
        return false;
    (cells ? cells_of : radiance_of_harmonics)(b, weights, rgb);
    return true;
}

// ---- all ----------------------------------------------------------------------------------------

static void project_on_cells(const struct basis *b, const struct image *rgb, double rotate,
                             float *weights) {
    const size_t count = (size_t)b->width * (size_t)b->height;
    double *cells = mem_array(3 * count, sizeof *cells);
    double *scratch = mem_array(2 * (size_t)(b->width + b->height), sizeof *scratch);
    resample(rgb, rotate, b->width, b->height, cells);
    for (size_t k = 0; k < 3; k++) {
        if (b->transformed)
            wavelet_forward_matrix(b->wavelet, cells + k * count, (size_t)b->height,
                                   (size_t)b->width, scratch);
        for (size_t i = 0; i < count; i++)
            weights[3 * i + k] = (float)cells[k * count + i];
    }
    mem_free(cells);
    mem_free(scratch);
}

static bool environment_weights(const struct basis *b, const struct relight_lighting *l,
                                const float *own, float *weights) {
    struct image rgb;
    if (!(l->environment ? read_environment(l->environment, &rgb) : own_environment(b, own, &rgb)))
        return false;
    if (b->kind == HARMONICS)
        harmonics_of(&rgb, l->rotate, b->order, weights);
    else
        project_on_cells(b, &rgb, l->rotate, weights);
    image_finish(&rgb);
    return true;
}

static bool no_light(const struct basis *b, const char *text) {
    char known[300] = "";
    size_t used = 0;
    for (size_t i = 0; i < json_count(b->lights) && used < sizeof known; i++) {
        const char *name = json_text(json_at(b->lights, i));
        used += (size_t)snprintf(known + used, sizeof known - used, " %s", name ? name : "");
    }
    log_error("--light %s: the tensor has no light of that name; there are:%s", text, known);
    return false;
}

// Applies "NAME=R,G,B" or "NAME=X".
static bool scale_light(const struct basis *b, const char *text, float *weights) {
    float rgb[3];
    const size_t length = light_factor_parse(text, "--light", rgb);
    if (!length)
        return false;
    for (size_t i = 0; i < json_count(b->lights); i++) {
        const char *name = json_text(json_at(b->lights, i));
        if (!name || strlen(name) != length || strncmp(name, text, length) != 0)
            continue;
        for (size_t k = 0; k < 3; k++)
            weights[3 * i + k] *= rgb[k];
        return true;
    }
    return no_light(b, text);
}

static bool lighting_fits(const struct basis *b, const struct relight_lighting *l, const float *own,
                          const char *path) {
    if (b->kind == LIGHTS && (l->environment || l->rotate != 0))
        log_error("%s: its coefficients are lights of the scene; --env and --rotate need --basis "
                  "pixels, sh, haar or daub4", path);
    else if (!own && !l->environment)
        log_error("%s: its coefficients are without the scene's own lighting; give --env", path);
    else if (l->light_count && b->kind != LIGHTS)
        log_error("%s: --light needs a tensor of --basis lights", path);
    else
        return true;
    return false;
}

bool relight_weights(const struct tensor *t, const char *path, const struct relight_lighting *l,
                     float *weights) {
    struct basis b;
    if (!read_basis(t, path, &b))
        return false;
    const struct tensor_block *block = &t->blocks[0];
    if (!lighting_fits(&b, l, block->weights, path))
        return false;
    if (!l->environment && l->rotate == 0)
        memcpy(weights, block->weights, 3 * (size_t)block->coefficients * sizeof *weights);
    else if (!environment_weights(&b, l, block->weights, weights))
        return false;
    for (size_t i = 0; i < l->light_count; i++)
        if (!scale_light(&b, l->lights[i], weights))
            return false;
    if (l->terms && l->terms < block->coefficients)
        keep_largest(weights, block->coefficients, l->terms);
    return true;
}
