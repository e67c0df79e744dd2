// SPDX-License-Identifier: Apache-2.0
// The tracer: sensor x integrator x sink over tiles and threads. Whatever sums samples is driven by it.
//
// What a tile gathers depends on scene, options and sample numbers, not on threads or on the crop.
#pragma once

#include <signal.h>

#include "filter/filter.h"
#include "integrator/integrator.h"
#include "sensor/sensor.h"
#include "sink/sample_map.h"

struct tracer_options {
    const struct world *world;
    const struct object *sensor, *integrator; // prepared
    const struct filter_sampler *filter;
    const struct response *response; // NULL: the physical one
    const struct sampler_type *sampler;
    uint32_t spp;        // samples per pixel the sampler lays its points out for, >= 1
    uint32_t seed;
    uint32_t replicates; // independent scramblings a pixel's samples are dealt to: 1 to 16, power of 2
    const struct sample_map *map; // NULL: every pixel takes every sample
    int threads;         // 0: default
    const volatile sig_atomic_t *stop; // becomes non-zero: finish within two seconds; or NULL
    // NULL, or told between tiles how many of a run are closed, on the thread that has called it.
    void (*closed)(void *user, uint32_t tiles);
    void *closed_user;
};

struct tracer_counts {
    uint64_t rays, shadow_rays, paths, truncated;
};

struct tracer;

// make_sink is called once per worker; the tracer destroys the sinks.
struct tracer *tracer_create(const struct tracer_options *options,
                             struct sink *(*make_sink)(void *context), void *context);
int tracer_threads(const struct tracer *t);
// Traces samples (steps of the map) [first, first + count) of tiles [tile, tile + tiles), in order
// for each pixel. false: given up because of a stop; some tiles were not closed.
bool tracer_run(struct tracer *t, uint32_t tile, uint32_t tiles, uint32_t first, uint32_t count);
struct tracer_counts tracer_count(const struct tracer *t);
void tracer_destroy(struct tracer *t);
