// SPDX-License-Identifier: Apache-2.0
#include "image/oiio.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <unistd.h>

#include "base/file.h"
#include "base/log.h"

static struct {
    pthread_once_t once;
    oiio_module_decode_function *decode;
    oiio_module_decode_function *decode_voxels;
    oiio_module_decode_function *display;
    oiio_module_write_png_function *write_png;
    char error[512];
} module = {.once = PTHREAD_ONCE_INIT}; // loaded once, constant from then on

static const struct oiio_host host = {decoder_init_image, image_set_text, image_from_rec709};

static void *open_module(void) {
    static const char *const places[] = {"../lib", "../lib/relume"};
    char program[4096], directory[4096], path[8192];
    const ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
    program[n > 0 ? n : 0] = '\0';
    file_directory(program, directory, sizeof directory);
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s/librelume_oiio.so", directory, places[i]);
        if (file_exists(path))
            return dlopen(path, RTLD_LAZY | RTLD_LOCAL);
    }
    snprintf(module.error, sizeof module.error,
             "librelume_oiio.so is neither in %.200s/../lib nor in ../lib/relume", directory);
    return NULL;
}

static bool is_complete(void) {
    return module.decode && module.decode_voxels && module.display && module.write_png;
}

static void load(void) {
    void *handle = open_module();
    if (handle) {
        module.decode = (oiio_module_decode_function *)dlsym(handle, "oiio_module_decode");
        module.decode_voxels =
            (oiio_module_decode_function *)dlsym(handle, "oiio_module_decode_voxels");
        module.display = (oiio_module_decode_function *)dlsym(handle, "oiio_module_display");
        module.write_png = (oiio_module_write_png_function *)dlsym(handle, "oiio_module_write_png");
    }
    if (is_complete())
        return;
    const char *why = dlerror();
    if (!module.error[0])
        snprintf(module.error, sizeof module.error, "%s", why ? why : "unknown error");
}

bool oiio_load(void) {
    pthread_once(&module.once, load);
    if (is_complete())
        return true;
    log_error("pictures other than EXR cannot be read or written: %s", module.error);
    return false;
}

bool oiio_decode(struct decoder_input *in, struct image *im) {
    return module.decode(&host, in, im);
}

bool oiio_decode_voxels(struct decoder_input *in, struct image *im) {
    return module.decode_voxels(&host, in, im);
}

bool oiio_display(struct decoder_input *in, struct image *im) {
    return module.display(&host, in, im);
}

bool oiio_write_png(const char *path, const unsigned char *bytes, int width, int height,
                    int channels, bool srgb, char *message, size_t n) {
    return module.write_png(path, bytes, width, height, channels, srgb, message, n);
}
