// SPDX-License-Identifier: Apache-2.0
#include "driver/polynomial_tail.h"

#include "base/log.h"
#include "integrator/path.h"
#include "sink/bounce_sums.h"

enum { PILOT_PATHS = 1 << 18, LEAST_SAMPLES = 8 };

// Asked at every vertex: the world shades what is editable as white where it shades together.
static struct bounce_sums *measure(const struct polynomial *p) {
    const struct film_options *f = &p->job.film;
    const struct response whole = {.resolve = response_physical.resolve};
    struct bounce_sums *b = bounce_sums_create((struct sink_area){f->x0, f->y0, f->x1, f->y1});
    struct tracer_options o = p->tracer;
    const uint32_t pixels = (uint32_t)((f->x1 - f->x0) * (f->y1 - f->y0));
    o.spp = PILOT_PATHS / (pixels ? pixels : 1);
    o.spp = o.spp > LEAST_SAMPLES ? o.spp : LEAST_SAMPLES;
    o.response = &whole;
    struct tracer *t = tracer_create(&o, bounce_sums_sink, b);
    tracer_run(t, 0, tile_grid_count(&b->grid), 0, o.spp);
    tracer_destroy(t);
    return b;
}

bool polynomial_radius(const struct polynomial *p, uint32_t bounces, double radius[3]) {
    double last[3], before[3], most = 0;
    if (bounces < 2) {
        log_error("--tail geometric: expected at least 2 --bounces, whose ratio it goes on with");
        return false;
    }
    struct bounce_sums *b = measure(p);
    bounce_sums_of(b, bounces, last);
    bounce_sums_of(b, bounces - 1, before);
    bounce_sums_destroy(b);
    for (int k = 0; k < 3; k++) {
        radius[k] = before[k] > 0 ? last[k] / before[k] : 0;
        most = radius[k] > most ? radius[k] : most;
    }
    if (most <= POLYNOMIAL_MOST_RADIUS)
        return true;
    log_error("--tail geometric: bounce %u has %.3f of the light of the one before, more than %g: the "
              "sum of those after it is not known; take --tail frozen", bounces, most,
              POLYNOMIAL_MOST_RADIUS);
    return false;
}
