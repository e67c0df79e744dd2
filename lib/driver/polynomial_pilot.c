// SPDX-License-Identifier: Apache-2.0
#include "driver/polynomial_pilot.h"

#include "base/log.h"
#include "integrator/path.h"
#include "sink/bounce_sums.h"
#include "sink/object_sums.h"

enum { PILOT_PATHS = 1 << 18, LEAST_SAMPLES = 8 };

static struct sink_area area_of(const struct polynomial *p) {
    const struct film_options *f = &p->job.film;
    return (struct sink_area){f->x0, f->y0, f->x1, f->y1};
}

static void trace(const struct polynomial *p, const struct response *response, uint32_t tiles,
                  struct sink *(*make_sink)(void *), void *sums) {
    const struct film_options *f = &p->job.film;
    struct tracer_options o = p->tracer;
    const uint32_t pixels = (uint32_t)((f->x1 - f->x0) * (f->y1 - f->y0));
    o.spp = PILOT_PATHS / (pixels ? pixels : 1);
    o.spp = o.spp > LEAST_SAMPLES ? o.spp : LEAST_SAMPLES;
    o.response = response;
    struct tracer *t = tracer_create(&o, make_sink, sums);
    tracer_run(t, 0, tiles, 0, o.spp);
    tracer_destroy(t);
}

// ---- the geometric tail -------------------------------------------------------------------------

bool polynomial_radius(const struct polynomial *p, uint32_t bounces, double radius[3]) {
    // Asked at every vertex: the world shades what is editable as white where it shades together.
    const struct response whole = {.resolve = response_physical.resolve};
    double last[3], before[3], most = 0;
    if (bounces < 2) {
        log_error("--tail geometric: expected at least 2 --bounces, whose ratio it goes on with");
        return false;
    }
    struct bounce_sums *b = bounce_sums_create(area_of(p));
    trace(p, &whole, tile_grid_count(&b->grid), bounce_sums_sink, b);
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

// ---- what objects pass on -----------------------------------------------------------------------

// The materials as they are, with a list of what later hops meet.
struct census {
    struct response response; // first
    const struct polynomial *p;
    uint32_t bounces;
};

static const struct closure *resolve(const struct response *response,
                                     const struct trace_context *ctx, int lane, uint32_t depth,
                                     const struct surface *s, vec3 wo) {
    const struct census *c = (const void *)response;
    const int object = c->p->response.object_of_shape[s->shape];
    struct marks *met = &ctx->sink->chains[lane].later[CHAIN_PATH];
    if (depth > 0 && depth < c->bounces && object != CHAIN_FIXED && met->count < CHAIN_MARKS)
        met->mark[met->count++].index = (uint32_t)object;
    return bsdf_resolve(s->bsdf, &s->point, wo, ctx->stack);
}

void polynomial_passed(const struct polynomial *p, uint32_t bounces,
                       double (*passed)[CURVE_CHANNELS]) {
    const struct census census = {{.resolve = resolve}, p, bounces};
    struct object_sums *s = object_sums_create(area_of(p), p->plan.count);
    trace(p, &census.response, tile_grid_count(&s->grid), object_sums_sink, s);
    for (uint32_t i = 0; i < p->plan.count; i++)
        object_sums_of(s, i, passed[i]);
    object_sums_destroy(s);
}
