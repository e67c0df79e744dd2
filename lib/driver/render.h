// SPDX-License-Identifier: Apache-2.0
// A picture: samples are traced into a film in passes, until a limit is met.
//
// The picture is a function of scene, options and seed, not of the number of threads, the crop or
// where the work was cut into passes.
#pragma once

#include "driver/tracer.h"
#include "sink/film.h"

struct render_options {
    struct tracer_options tracer;
    uint64_t end;        // stop at the sample of this number
    double seconds;      // stop after so long; 0: no limit
    double noise;        // stop when film_noise is no more than this; 0: no limit
    // Called between passes, with the share done; NULL: nobody listens.
    void (*progress)(void *user, double done, const struct film *film);
    void *user;
};

struct render_result {
    uint64_t samples; // of every pixel
    bool stopped;     // before any limit, or short of the noise that was asked for
    double noise;     // of the picture; negative: not known
    double seconds;
    uint64_t rays, shadow_rays, paths, truncated;
};

// Traces what the film lacks.
void render(struct film *film, const struct render_options *options, struct render_result *result);
// The same as far as the end of a block that was begun.
void render_to_block(struct film *film, const struct render_options *options);
