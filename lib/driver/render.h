// SPDX-License-Identifier: Apache-2.0
// The driver: runs sensor, integrator and sink over tiles, samples and threads.
//
// The picture is a function of scene, options and seed, not of the number of threads, the crop or
// where the work was cut into passes.
#pragma once

#include <signal.h>

#include "filter/filter.h"
#include "integrator/integrator.h"
#include "sensor/sensor.h"
#include "sink/film.h"

struct render_options {
    const struct sampler_type *sampler;
    uint32_t spp;        // samples per pixel the sampler lays its points out for, >= 1
    uint64_t end;        // stop at the sample of this number
    double seconds;      // stop after so long; 0: no limit
    double noise;        // stop when film_noise is no more than this; 0: no limit
    uint32_t seed;
    uint32_t replicates; // independent scramblings a pixel's samples are dealt to: 1 to 16, power of 2
    int threads;         // 0: default
    const volatile sig_atomic_t *stop; // becomes non-zero: finish within two seconds
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

// Traces into the film. sensor and integrator are prepared objects.
void render(const struct world *world, const struct object *sensor, const struct object *integrator,
            const struct filter_sampler *filter, struct film *film,
            const struct render_options *options, struct render_result *result);
