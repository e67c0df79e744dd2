// SPDX-License-Identifier: Apache-2.0
#include "image/denoise.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"

// The part of the library's C interface that is used, the same in both versions but for two names.
enum { DEVICE_CPU = 1, FORMAT_FLOAT3 = 3 };

struct library {
    void *handle;
    void *(*new_device)(int type);
    void (*set_device_int)(void *device, const char *name, int value);
    int (*get_device_int)(void *device, const char *name);
    void (*commit_device)(void *device);
    int (*get_device_error)(void *device, const char **message);
    void (*release_device)(void *device);
    void *(*new_filter)(void *device, const char *type);
    void (*set_image)(void *filter, const char *name, void *pixels, int format, size_t width,
                      size_t height, size_t offset, size_t pixel_stride, size_t row_stride);
    void (*set_filter_bool)(void *filter, const char *name, bool value);
    void (*commit_filter)(void *filter);
    void (*execute_filter)(void *filter);
    void (*release_filter)(void *filter);
};

static bool find(const struct library *l, void *function, const char *name, const char *before) {
    void *found = dlsym(l->handle, name);
    if (!found && before)
        found = dlsym(l->handle, before);
    memcpy(function, &found, sizeof found);
    if (!found)
        log_error("Open Image Denoise has no function %s; expected version 1 or 2", name);
    return found;
}

static bool load(struct library *l) {
    static const char *const names[] = {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1",
                                        "libOpenImageDenoise.so.0", "libOpenImageDenoise.so", NULL};
    l->handle = NULL;
    for (int i = 0; names[i] && !l->handle; i++)
        l->handle = dlopen(names[i], RTLD_LAZY | RTLD_LOCAL);
    if (!l->handle) {
        log_error("Open Image Denoise is not installed: %s was not found; it is at "
                  "www.openimagedenoise.org, and LD_LIBRARY_PATH can name its folder", names[0]);
        return false;
    }
    return find(l, &l->new_device, "oidnNewDevice", NULL) &&
           find(l, &l->set_device_int, "oidnSetDeviceInt", "oidnSetDevice1i") &&
           find(l, &l->get_device_int, "oidnGetDeviceInt", "oidnGetDevice1i") &&
           find(l, &l->commit_device, "oidnCommitDevice", NULL) &&
           find(l, &l->get_device_error, "oidnGetDeviceError", NULL) &&
           find(l, &l->release_device, "oidnReleaseDevice", NULL) &&
           find(l, &l->new_filter, "oidnNewFilter", NULL) &&
           find(l, &l->set_image, "oidnSetSharedFilterImage", NULL) &&
           find(l, &l->set_filter_bool, "oidnSetFilterBool", "oidnSetFilter1b") &&
           find(l, &l->commit_filter, "oidnCommitFilter", NULL) &&
           find(l, &l->execute_filter, "oidnExecuteFilter", NULL) &&
           find(l, &l->release_filter, "oidnReleaseFilter", NULL);
}

// ---- layers -------------------------------------------------------------------------------------

static const char *const colour_names[] = {"R", "G", "B"};
static const char *const albedo_names[] = {"albedo.R", "albedo.G", "albedo.B"};
static const char *const normal_names[] = {"N.X", "N.Y", "N.Z"};

static bool has_layer(const struct image *im, const char *const names[3]) {
    return image_find_channel(im, names[0]) >= 0 && image_find_channel(im, names[1]) >= 0 &&
           image_find_channel(im, names[2]) >= 0;
}

// Three floats a pixel, owned by the caller. *bad counts what is not finite.
static float *take_layer(const struct image *im, const char *const names[3], uint64_t *bad) {
    const size_t pixels = (size_t)im->width * (size_t)im->height;
    float *out = mem_array(3 * pixels, sizeof *out);
    for (size_t c = 0; c < 3; c++) {
        const size_t from = (size_t)image_find_channel(im, names[c]);
        for (size_t i = 0; i < pixels; i++) {
            const float v = im->pixels[i * (size_t)im->channels + from];
            *bad += !isfinite(v);
            out[3 * i + c] = isfinite(v) ? v : 0;
        }
    }
    return out;
}

static void put_colour(struct image *im, const float *colour) {
    const size_t pixels = (size_t)im->width * (size_t)im->height;
    for (size_t c = 0; c < 3; c++) {
        const size_t to = (size_t)image_find_channel(im, colour_names[c]);
        for (size_t i = 0; i < pixels; i++)
            im->pixels[i * (size_t)im->channels + to] = colour[3 * i + c];
    }
}

// Takes the variances of the undenoised picture out.
static void drop_variance(struct image *im) {
    const size_t pixels = (size_t)im->width * (size_t)im->height;
    int kept = 0;
    for (int c = 0; c < im->channels; c++) {
        if (strncmp(im->channel_names[c], "variance.", 9) == 0)
            continue;
        memmove(im->channel_names[kept], im->channel_names[c], IMAGE_NAME_SIZE);
        for (size_t i = 0; i < pixels; i++)
            im->pixels[i * (size_t)im->channels + (size_t)kept] =
                im->pixels[i * (size_t)im->channels + (size_t)c];
        kept++;
    }
    for (size_t i = 0; i < pixels && kept < im->channels; i++)
        memmove(im->pixels + i * (size_t)kept, im->pixels + i * (size_t)im->channels,
                (size_t)kept * sizeof(float));
    im->channels = kept;
}

// Nor is the noise that was measured that of the picture now.
static void forget_noise(struct image *im) {
    int kept = 0;
    for (int i = 0; i < im->attribute_count; i++) {
        if (strcmp(im->attributes[i].name, "relume.noise") == 0)
            mem_free(im->attributes[i].text);
        else
            im->attributes[kept++] = im->attributes[i];
    }
    im->attribute_count = kept;
}

// ---- the filter ---------------------------------------------------------------------------------

struct layers {
    float *colour, *albedo, *normal, *out; // albedo and normal: NULL, unused
    size_t width, height;
};

static bool went_well(const struct library *l, void *device) {
    const char *message = NULL;
    if (l->get_device_error(device, &message) == 0)
        return true;
    log_error("Open Image Denoise: %s", message ? message : "an error without a message");
    return false;
}

static bool filter_layers(const struct library *l, void *device, const struct layers *a) {
    void *filter = l->new_filter(device, "RT");
    if (!filter)
        return went_well(l, device);
    l->set_image(filter, "color", a->colour, FORMAT_FLOAT3, a->width, a->height, 0, 0, 0);
    if (a->albedo)
        l->set_image(filter, "albedo", a->albedo, FORMAT_FLOAT3, a->width, a->height, 0, 0, 0);
    if (a->albedo && a->normal) // the library takes normals beside albedo only
        l->set_image(filter, "normal", a->normal, FORMAT_FLOAT3, a->width, a->height, 0, 0, 0);
    l->set_image(filter, "output", a->out, FORMAT_FLOAT3, a->width, a->height, 0, 0, 0);
    l->set_filter_bool(filter, "hdr", true);
    l->commit_filter(filter);
    l->execute_filter(filter);
    l->release_filter(filter);
    return went_well(l, device);
}

static void label(struct image *im, const struct library *l, void *device, const struct layers *a) {
    char text[128];
    const int version = l->get_device_int(device, "version"); // 10000 major + 100 minor + patch
    snprintf(text, sizeof text, "Open Image Denoise %d.%d.%d%s%s", version / 10000,
             version / 100 % 100, version % 100, a->albedo ? ", with albedo" : "",
             a->albedo && a->normal ? " and normals" : "");
    image_set_text(im, "relume.denoised", text);
}

static bool run(const struct library *l, struct image *im, const struct denoise_options *o,
                const struct layers *a) {
    void *device = l->new_device(DEVICE_CPU);
    if (!device)
        return went_well(l, NULL);
    l->set_device_int(device, "numThreads", o->threads > 0 ? o->threads : thread_default_count());
    l->commit_device(device);
    const bool good = went_well(l, device) && filter_layers(l, device, a);
    if (good)
        label(im, l, device, a);
    l->release_device(device);
    return good;
}

bool denoise(struct image *im, const struct denoise_options *options) {
    struct library l;
    uint64_t bad = 0;
    if (!has_layer(im, colour_names)) {
        log_error("there are no channels R, G and B to denoise");
        return false;
    }
    if (!load(&l))
        return false;
    struct layers a = {.width = (size_t)im->width, .height = (size_t)im->height};
    a.colour = take_layer(im, colour_names, &bad);
    if (!options->colour_only && has_layer(im, albedo_names))
        a.albedo = take_layer(im, albedo_names, &bad);
    if (!options->colour_only && has_layer(im, normal_names))
        a.normal = take_layer(im, normal_names, &bad);
    a.out = mem_array(3 * a.width * a.height, sizeof *a.out);
    if (bad)
        log_warn("%llu values that are not finite count as 0", (unsigned long long)bad);
    const bool good = run(&l, im, options, &a);
    if (good) {
        put_colour(im, a.out);
        drop_variance(im);
        forget_noise(im);
    }
    mem_free(a.colour);
    mem_free(a.albedo);
    mem_free(a.normal);
    mem_free(a.out);
    return good;
}
