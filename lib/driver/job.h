// SPDX-License-Identifier: Apache-2.0
// A picture from a scene file: everything between the command line and the finished image.
#pragma once

#include "driver/render.h"

struct job_options {
    const char *scene;
    struct scene_options reading; // registries are filled in by job_run
    int spp;                      // 0: what the scene asks for, else 64
    int crop[4];                  // x0, y0, x1, y1; all 0: the scene's
    const char *max_depth;        // number as text, or NULL: the scene's
    uint32_t seed;
    int threads;
    const char *aovs;             // "albedo,N" or NULL
    bool variance, light_groups, paths;
    const volatile sig_atomic_t *stop;
    void (*progress)(void *user, double done, const struct film *film);
    void *user;
};

struct job_result {
    struct image image;
    struct render_result render;
    uint64_t rejected;      // samples that were NaN or infinite
    double noise;           // film_noise, negative: not measured
    double load_seconds, accel_seconds, first_pixel_seconds;
    uint64_t triangles;
    size_t accel_bytes;
    uint64_t scene_hash;
};

// The registries of everything a scene may name.
struct scene_registries job_registries(void);

// Reads, builds, renders. false after an error message. image_finish(&result->image) when done.
bool job_run(const struct job_options *options, struct job_result *result);
