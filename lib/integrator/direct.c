// SPDX-License-Identifier: Apache-2.0
// Direct light only, with any number of light and material samples that share by MIS.
#include "integrator/vertex.h"

#include "base/log.h"

struct direct {
    int shading_samples, emitter_samples, bsdf_samples;
    bool hide_emitters;
    int light_choice;
};

static const struct param params[] = {
    {"shading_samples", PARAM_INT, offsetof(struct direct, shading_samples), .def = "1", .min = 1,
     .max = 1024, .unit = "", .help = "samples of lights and of materials, unless given apart"},
    {"emitter_samples", PARAM_INT, offsetof(struct direct, emitter_samples), .def = "-1", .min = -1,
     .max = 1024, .unit = "", .help = "light samples at each point; -1: shading_samples"},
    {"bsdf_samples", PARAM_INT, offsetof(struct direct, bsdf_samples), .def = "-1", .min = -1,
     .max = 1024, .unit = "", .help = "material samples at each point; -1: shading_samples"},
    {"hide_emitters", PARAM_BOOL, offsetof(struct direct, hide_emitters), .def = "false",
     .unit = "", .help = "do not show lights that are seen directly"},
    INTEGRATOR_LIGHT_CHOICE(struct direct, light_choice),
    INTEGRATOR_IGNORED,
    PARAM_END,
};

static bool prepare(struct object *self, struct integrator_wants *wants) {
    struct direct *d = self->data;
    wants->light_choice = (enum light_choice_mode)d->light_choice;
    if (d->emitter_samples < 0)
        d->emitter_samples = d->shading_samples;
    if (d->bsdf_samples < 0)
        d->bsdf_samples = d->shading_samples;
    if (d->emitter_samples + d->bsdf_samples > 0)
        return true;
    log_error_at(self->at, "direct: emitter_samples and bsdf_samples are both 0");
    return false;
}

static void sample_light(const struct direct *d, struct trace_context *ctx, int lane,
                         const struct surface *s, const struct closure *closure, vec3 side,
                         spectrum beta, struct sampler *sampler) {
    struct shadow_test test;
    const float rivals = (float)d->bsdf_samples / (float)d->emitter_samples;
    const float u = sampler_1d(sampler);
    vertex_sample_light(ctx, s, closure, side, u, sampler_2d(sampler), rivals, &test);
    if (!test.pending)
        return;
    test.contribution.weight *= beta / (float)d->emitter_samples;
    test.contribution.depth = 1;
    test.contribution.lobe = closure->lobes;
    vertex_finish_light(ctx, lane, &test);
}

// Follows a sampled direction to the lights on it, straight through whatever lets light pass.
static void sample_material(const struct direct *d, struct trace_context *ctx, int lane,
                            const struct surface *s, const struct closure *closure, vec3 side,
                            spectrum beta, struct sampler *sampler) {
    struct bsdf_sample b;
    const float u = sampler_1d(sampler);
    if (!closure_sample(closure, u, sampler_2d(sampler), &b) || b.lobe & LOBE_NULL)
        return;
    const vec3 wi = to_world(&s->point.frame, b.wi);
    // Scaling the density by the ratio of counts makes the two-sample heuristic the counted one.
    const float ratio = (float)d->bsdf_samples / (float)(d->emitter_samples ? d->emitter_samples : 1);
    const struct path_origin from = {s->p, b.pdf_sa * ratio,
                                     b.lobe & LOBE_DELTA || d->emitter_samples == 0, 1, b.lobe,
                                     side, s->shape + 1};
    struct ray ray = {surface_offset(s, wi), wi, 0, INFINITY};
    beta *= b.weight / (float)d->bsdf_samples;
    for (int i = 0; i < 64 && !spectrum_is_black(beta); i++) {
        struct accel_hit hit;
        struct surface next;
        ctx->rays++;
        if (!accel_intersect(ctx->world->accel, &ray, &hit)) {
            vertex_add_infinite(ctx, lane, wi, beta, &from);
            return;
        }
        world_surface(ctx->world, &ray, &hit, &next);
        vertex_add_emission(ctx, lane, &next, wi, beta, &from);
        const struct object *o = next.bsdf;
        if (!bsdf_type_of(o)->null_transmittance)
            return;
        beta *= bsdf_type_of(o)->null_transmittance(o->data, &next.point,
                                                    to_local(&next.point.frame, -wi));
        ray.o = surface_offset(&next, wi);
    }
}

// Light reflected at the surface the sensor's ray meets; a null lobe is entered by chance.
static void trace_one(const struct direct *d, struct trace_context *ctx, int lane,
                      const struct path_start *start) {
    struct ray ray = start->ray;
    struct sampler sampler = start->sampler;
    spectrum beta = spectrum_grey(1);
    const struct path_origin from = {.p = ray.o, .delta = true};
    for (int events = 0; events < INTEGRATOR_MOST_EVENTS; events++) {
        struct accel_hit hit;
        struct surface s;
        ctx->rays++;
        accel_intersect(ctx->world->accel, &ray, &hit);
        if (ctx->world->hides)
            world_see(ctx->world, &ray, &hit);
        if (hit.shape == SCENE_NONE) {
            if (!d->hide_emitters)
                vertex_add_infinite(ctx, lane, ray.d, beta, &from);
            return;
        }
        world_surface(ctx->world, &ray, &hit, &s);
        if (!d->hide_emitters)
            vertex_add_emission(ctx, lane, &s, ray.d, beta, &from);
        const vec3 wo = to_local(&s.point.frame, -ray.d);
        const struct object *o = s.bsdf;
        const struct bsdf_type *type = bsdf_type_of(o);
        const spectrum through = type->null_transmittance
                                     ? type->null_transmittance(o->data, &s.point, wo)
                                     : spectrum_grey(0);
        const float pass = minf(spectrum_max(through), 1);
        if (pass > 0 && sampler_1d(&sampler) < pass) {
            beta *= through / pass;
            ray.o = surface_offset(&s, ray.d);
            ray.tmin = 0;
            continue;
        }
        beta /= 1 - pass;
        ctx->sink->type->covered(ctx->sink, lane);
        const struct closure *closure = response_resolve(ctx, lane, 0, &s, wo);
        if (ctx->sink->wants_surface)
            vertex_add_first(ctx, lane, &s, closure);
        const vec3 side = closure ? vertex_light_side(&s, closure, wo) : v3(0, 0, 0);
        for (int i = 0; closure && closure->lobes & LOBE_SMOOTH && i < d->emitter_samples; i++)
            sample_light(d, ctx, lane, &s, closure, side, beta, &sampler);
        for (int i = 0; closure && i < d->bsdf_samples; i++)
            sample_material(d, ctx, lane, &s, closure, side, beta, &sampler);
        return;
    }
    ctx->truncated++;
}

static void trace(const void *data, struct trace_context *ctx,
                  const struct path_start starts[SINK_LANES]) {
    for (int i = 0; i < SINK_LANES; i++) {
        ctx->paths++;
        trace_one(data, ctx, i, &starts[i]);
    }
}

const struct integrator_type integrator_direct = {
    .entry = {.name = "direct", .help = "direct light only, lights and materials sampled (Veach 1997)",
              .params = params, .size = sizeof(struct direct)},
    .prepare = prepare, .trace = trace,
};
