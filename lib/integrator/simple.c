// SPDX-License-Identifier: Apache-2.0
// A path tracer that is as plain as it can be, as a reference for tests: directions come from the
// material alone, light is found by running into it, only delta lights are sampled, nothing is
// weighted against anything else, no path ends early.
#include "integrator/vertex.h"

struct simple {
    int max_depth;
};

static const struct param params[] = {
    {"max_depth", PARAM_INT, offsetof(struct simple, max_depth), .def = "-1", .min = -1, .max = 1e6,
     .unit = "", .help = "most edges of a path; -1: no limit"},
    INTEGRATOR_IGNORED,
    PARAM_END,
};

// Every delta light, one after the other.
static void add_delta_lights(struct trace_context *ctx, int lane, const struct surface *s,
                             const struct closure *closure, spectrum beta,
                             const struct path_origin *from, int most_passes) {
    for (uint32_t i = 0; i < ctx->world->light_count; i++) {
        const struct world_light *light = &ctx->world->lights[i];
        struct light_sample l;
        float pdf;
        if (!light->type->delta || !world_links(ctx->world, i, s->shape) ||
            !light->type->sample(light->data, s->p, (struct vec2){0.5f, 0.5f}, &l))
            continue;
        const spectrum f = closure_eval(closure, to_local(&s->point.frame, l.wi), &pdf);
        const struct wavelengths rgb = {0};
        const spectrum through = world_transmittance(ctx->world, world_shadow_ray(s, &l), most_passes, rgb);
        sink_add(ctx->sink, lane,
                 &(struct contribution){beta * f * through / l.pdf_sa, l.emission, i, from->depth + 1,
                                        from->depth ? from->lobe : closure->lobes, true, l.wi});
    }
}

static void trace_one(const struct simple *p, struct trace_context *ctx, int lane,
                      const struct path_start *start) {
    struct ray ray = start->ray;
    struct sampler sampler = start->sampler;
    spectrum beta = spectrum_grey(1);
    struct path_origin from = {.p = ray.o, .delta = true};
    for (int events = 0; p->max_depth < 0 || events < p->max_depth; events++) {
        struct accel_hit hit;
        struct surface s;
        struct bsdf_sample b;
        if (events >= INTEGRATOR_MOST_EVENTS) {
            ctx->truncated++;
            return;
        }
        ctx->rays++;
        from.delta = true; // whatever is found counts in full
        accel_intersect(ctx->world->accel, &ray, &hit);
        if (ctx->world->hides && from.depth == 0)
            world_see(ctx->world, &ray, &hit);
        if (hit.shape == SCENE_NONE) {
            vertex_add_infinite(ctx, lane, ray.d, beta, &from);
            return;
        }
        world_surface(ctx->world, &ray, &hit, &s);
        vertex_add_emission(ctx, lane, &s, ray.d, beta, &from);
        const vec3 wo = to_local(&s.point.frame, -ray.d);
        const struct closure *closure = response_resolve(ctx, lane, from.depth, &s, wo);
        if (!closure)
            return;
        if (p->max_depth < 0 || events + 1 < p->max_depth)
            add_delta_lights(ctx, lane, &s, closure, beta, &from,
                             p->max_depth < 0 ? -1 : p->max_depth - 2 - events);
        const float lobe = sampler_1d(&sampler);
        if (!closure_sample(closure, lobe, sampler_2d(&sampler), &b))
            return;
        beta *= b.weight;
        if (spectrum_is_black(beta)) // also by underflow, in closed rooms
            return;
        const bool passes = (b.lobe & LOBE_NULL) != 0;
        const vec3 wi = passes ? ray.d : to_world(&s.point.frame, b.wi);
        if (!passes) {
            from.lobe = from.depth ? from.lobe : b.lobe;
            from.depth++;
            from.p = s.p;
            from.receiver = s.shape + 1;
        }
        ray = (struct ray){surface_offset(&s, wi), wi, 0, INFINITY};
    }
}

static void trace(const void *data, struct trace_context *ctx,
                  const struct path_start starts[SINK_LANES]) {
    for (int i = 0; i < SINK_LANES; i++) {
        ctx->paths++;
        trace_one(data, ctx, i, &starts[i]);
    }
}

const struct integrator_type integrator_simple = {
    .entry = {.name = "simple",
              .help = "plain path tracing without light sampling: slow, a reference for tests",
              .params = params, .size = sizeof(struct simple)},
    .trace = trace,
};
