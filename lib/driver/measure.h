// SPDX-License-Identifier: Apache-2.0
// Measuring at points: irradiance on little surfaces or radiance along rays, with standard errors.
//
// What a point measures depends on scene, options and its number in the list, not on the points that
// are measured with it.
#pragma once

#include "driver/job.h"
#include "sensor/points.h"
#include "sink/meters.h"

struct measure_options {
    bool radiance;    // along rays; else irradiance
    uint64_t samples; // of a point, rounded up to a multiple of METER_REPLICATES
    double noise;     // stop where the standard error is at most so much of the value; 0: no limit
};

struct measure_result {
    struct meter_reading reading;
    uint64_t samples;
    bool noisy; // noisier than asked for
};

struct measure; // a job made ready

// The job stays the caller's. NULL after an error message.
struct measure *measure_create(const struct job *job, const struct measure_options *options);
void measure_destroy(struct measure *m);
// The next `count` points of the list. false: given up because of a stop.
bool measure_points(struct measure *m, const struct sensor_point *points, uint32_t count,
                    struct measure_result *results);
uint64_t measure_rejected(const struct measure *m); // samples that were not finite
