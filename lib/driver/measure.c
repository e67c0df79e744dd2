// SPDX-License-Identifier: Apache-2.0
#include "driver/measure.h"

#include <math.h>

#include "base/log.h"
#include "base/mem.h"
#include "sink/sums.h"

struct measure {
    struct measure_options options;
    uint32_t most; // samples of a replicate
    struct tracer_options tracer;
    struct sensor_points points;
    struct object sensor;
    struct meters meters;
};

// The pixels of a point are its replicates, and must not know of each other.
static void untie_pixels(struct tracer_options *o) {
    if (!o->sampler->ties_pixels)
        return;
    log_warn("sampler %s ties neighbouring pixels together, which here are the repeats that errors "
             "come from: sobol is taken", o->sampler->entry.name);
    o->sampler = &sampler_sobol;
}

struct measure *measure_create(const struct job *job, const struct measure_options *options) {
    const struct scene *s = job->scene;
    const struct sensor_type *type =
        options->radiance ? &sensor_points_radiance : &sensor_points_irradiance;
    if (type->place && !integrator_meters(s->integrator)) {
        log_error_at(s->integrator->at, "integrator \"%s\" cannot measure irradiance; path and "
                     "volpath can (--integrator)", s->integrator->type->name);
        return NULL;
    }
    struct measure *m = mem_array(1, sizeof *m);
    m->options = *options;
    m->most = (uint32_t)((options->samples + METER_REPLICATES - 1) / METER_REPLICATES);
    m->points = (struct sensor_points){.radius = job->world->radius};
    for (int i = 0; i < 3; i++)
        m->points.centre[i] = s->centre[i];
    m->sensor = (struct object){&type->entry, &m->points, NULL, {0}};
    m->tracer = job->render.tracer;
    untie_pixels(&m->tracer);
    m->tracer.sensor = &m->sensor;
    m->tracer.filter = &filter_sampler_box;
    m->tracer.spp = m->most;
    m->tracer.replicates = 1; // each pixel is one
    m->tracer.map = NULL;
    m->meters.corner = sensor_point_corner;
    return m;
}

void measure_destroy(struct measure *m) {
    mem_free(m);
}

uint64_t measure_rejected(const struct measure *m) {
    return m->meters.rejected;
}

static double share(double error, double value) {
    return error > 0 ? error / fabs(value) : 0;
}

// The largest relative error of what may be printed.
static double noise(const struct meter_reading *r) {
    return share(r->luminance_error, r->luminance);
}

// Reads the meters that are still running; how many are not good enough.
static uint32_t read_all(struct measure *m, uint32_t count, uint64_t samples,
                         struct measure_result *results) {
    uint32_t noisy = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct meter *meter = &m->meters.items[i];
        struct measure_result *r = &results[i];
        if (meter->done)
            continue;
        r->reading = meter_read(meter, samples);
        r->samples = samples * METER_REPLICATES;
        r->noisy = m->options.noise > 0 && noise(&r->reading) > m->options.noise;
        meter->done = m->options.noise > 0 && !r->noisy;
        noisy += r->noisy;
    }
    return noisy;
}

bool measure_points(struct measure *m, const struct sensor_point *points, uint32_t count,
                    struct measure_result *results) {
    m->points.items = points;
    m->meters.first = m->points.first;
    m->meters.items = mem_array(count, sizeof *m->meters.items);
    struct tracer *tracer = tracer_create(&m->tracer, meters_sink, &m->meters);
    bool complete = true;
    for (uint32_t done = 0; complete && done < m->most;) {
        const uint32_t left = m->most - done;
        const uint32_t step = m->options.noise > 0 && left > SUMS_BLOCK ? SUMS_BLOCK : left;
        complete = tracer_run(tracer, m->points.first, count, done, step);
        done += step;
        if (complete && read_all(m, count, done, results) == 0 && m->options.noise > 0)
            break;
    }
    tracer_destroy(tracer);
    mem_free(m->meters.items);
    m->points.first += count;
    return complete;
}
