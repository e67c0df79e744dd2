// SPDX-License-Identifier: Apache-2.0
// Pictures of small scenes, for tests: from text to pixels in this process.
#pragma once

#include <stdbool.h>

#include "driver/job.h"
#include "scene_text.h"

// Whether the long version of a test is asked for (tests/run --full).
static inline bool full_mode(void) {
    const char *full = getenv("RELUME_TEST_FULL");
    return full && strcmp(full, "1") == 0;
}

// Renders a scene file, or exits: a scene of a test must be good. image_finish *im.
static inline void render_file(const char *path, const struct job_options *options,
                               struct image *im, struct render_result *result) {
    struct job_options o = *options;
    struct job job;
    o.scene = path;
    if (!job_open(&job, &o))
        exit(1);
    struct film *film = job_render(&job, result);
    if (!job_image(&job, film, result, im))
        exit(1);
    film_destroy(film);
    job_close(&job);
}

// The same for text; scene_folder_open() comes first.
static inline void render_text(const char *text, const struct job_options *options,
                               struct image *im, struct render_result *result) {
    scene_write("scene.xml", text);
    render_file(scene_path("scene.xml"), options, im, result);
}

static inline float *pixel_at(const struct image *im, int x, int y) {
    return im->pixels + ((size_t)y * (size_t)im->width + (size_t)x) * (size_t)im->channels;
}

// A mean with its standard error.
struct measured {
    double mean, error;
};

// Of one channel over the picture; the error from the pixels' replicates (layer `variance`), which
// the picture must have. Pixels are independent: each has its own scrambling.
static inline struct measured measure(const struct image *im, char channel) {
    const char value[2] = {channel, 0}, variance[] = {'v', 'a', 'r', 'i', 'a', 'n', 'c', 'e',
                                                       '.', channel, 0};
    const int c = image_find_channel(im, value), v = image_find_channel(im, variance);
    const int pixels = im->width * im->height;
    struct measured m = {0, 0};
    if (c < 0 || v < 0) {
        printf("no channel %s or %s\n", value, variance);
        exit(1);
    }
    for (int i = 0; i < pixels; i++) {
        m.mean += (double)im->pixels[(size_t)i * (size_t)im->channels + (size_t)c];
        m.error += (double)im->pixels[(size_t)i * (size_t)im->channels + (size_t)v];
    }
    m.mean /= pixels;
    m.error = sqrt(m.error) / pixels;
    return m;
}
