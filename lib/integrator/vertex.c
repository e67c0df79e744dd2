// SPDX-License-Identifier: Apache-2.0
#include "integrator/vertex.h"

void vertex_add_emission(struct trace_context *ctx, int lane, const struct surface *s, vec3 d,
                         spectrum beta, const struct path_origin *from) {
    const uint32_t index = s->light;
    if (index == SCENE_NONE)
        return;
    const struct world_light *light = &ctx->world->lights[index];
    const struct light_place place = {from->p, from->n};
    const vec3 to_light = s->p - from->p;
    const struct light_hit hit = {d, length(to_light), s->ng, s->point.at};
    const spectrum emission = light->type->emission(light->data, &hit);
    if (spectrum_is_black(emission) || !world_links(ctx->world, index, from->receiver - 1))
        return;
    float mis = 1;
    if (!from->delta)
        mis = mis_weight(from->pdf_sa, world_light_pdf_sa(ctx->world, index, &place, &hit));
    sink_add(ctx->sink, lane,
             &(struct contribution){mis * beta, emission, index, from->depth, from->lobe, false,
                                    d});
}

void vertex_add_infinite(struct trace_context *ctx, int lane, vec3 d, spectrum beta,
                         const struct path_origin *from) {
    const struct light_hit hit = {.wi = d, .distance = INFINITY};
    const struct light_place place = {from->p, from->n};
    for (uint32_t i = 0; i < ctx->world->infinite_count; i++) {
        const uint32_t index = ctx->world->infinite[i];
        const struct world_light *light = &ctx->world->lights[index];
        if ((light->hidden && from->depth == 0) ||
            !world_links(ctx->world, index, from->receiver - 1))
            continue;
        const spectrum emission = light->type->emission(light->data, &hit);
        float mis = 1;
        if (!from->delta)
            mis = mis_weight(from->pdf_sa, world_light_pdf_sa(ctx->world, index, &place, &hit));
        sink_add(ctx->sink, lane,
                 &(struct contribution){mis * beta, emission, index, from->depth, from->lobe, false,
                                        d});
    }
}

void vertex_sample_light(struct trace_context *ctx, const struct surface *s,
                         const struct closure *closure, vec3 side, float u1, struct vec2 u2,
                         float rivals, struct shadow_test *test) {
    const struct light_place place = {s->p, side};
    uint32_t light;
    struct light_sample l;
    test->pending = false;
    if (world_sample_light(ctx->world, &place, u1, u2, &light, &l))
        vertex_test_light(ctx, s, closure, light, &l, rivals, test);
}

void vertex_test_light(struct trace_context *ctx, const struct surface *s,
                       const struct closure *closure, uint32_t light, const struct light_sample *l,
                       float rivals, struct shadow_test *test) {
    float pdf_bsdf;
    if (!world_links(ctx->world, light, s->shape))
        return;
    const spectrum f = closure_eval(closure, to_local(&s->point.frame, l->wi), &pdf_bsdf);
    if (spectrum_is_black(f) || (!l->late && spectrum_is_black(l->emission)))
        return;
    const float share = l->delta ? 1 : mis_weight(l->pdf_sa, rivals * pdf_bsdf);
    const spectrum emission = l->late ? spectrum_grey(l->pdf_sa) : l->emission;
    test->contribution = (struct contribution){.weight = f * (share / l->pdf_sa), .emission = emission,
                                               .source = light, .sampled = true, .wi = l->wi};
    test->ray = world_shadow_ray(s, l);
    test->most_passes = -1;
    test->late = l->late;
    test->pending = true;
}

void vertex_add_light(struct trace_context *ctx, int lane, struct shadow_test *test) {
    struct contribution *c = &test->contribution;
    if (test->late)
        c->emission = light_late_emission(&ctx->world->lights[c->source], c->wi);
    if (!test->late || !spectrum_is_black(c->emission))
        sink_add(ctx->sink, lane, c);
}

void vertex_finish_light(struct trace_context *ctx, int lane, struct shadow_test *test) {
    const struct wavelengths rgb = {0};
    ctx->shadow_rays++;
    const spectrum through = world_transmittance(ctx->world, test->ray, test->most_passes, rgb);
    if (spectrum_is_black(through))
        return;
    test->contribution.weight *= through;
    vertex_add_light(ctx, lane, test);
}

// Normal, on the surface's outer side, of the frame that a material scatters in, which a bump or normal
// map tilts. A material around another takes directions into its frame: each axis tells a component.
static vec3 normal_of(const struct surface *s, const struct closure *closure) {
    vec3 n = v3(0, 0, 1);
    for (int axis = 0; axis < 3; axis++) {
        vec3 w = v3(axis == 0, axis == 1, axis == 2);
        float factor = 1;
        for (const struct closure *c = closure; c && c->type->inside;)
            c = c->type->inside(c, &w, &factor);
        n[axis] = w[2];
    }
    return to_world(&s->point.frame, n[2] < 0 ? -n : n);
}

void vertex_add_first(struct trace_context *ctx, int lane, const struct surface *s,
                      const struct closure *closure) {
    const double *c = ctx->world->scene->centre;
    const struct sink_surface first = {
        .p = s->p + v3((float)c[0], (float)c[1], (float)c[2]),
        .n = normal_of(s, closure),
        .ng = s->ng,
        .z = s->t,
        .uv = s->point.at.uv,
        .shape = s->shape + 1,
        .instance = s->instance == SCENE_NONE ? 0 : s->instance + 1,
        .albedo = closure && closure->type->albedo ? closure->type->albedo(closure)
                                                   : spectrum_grey(0)};
    ctx->sink->type->surface(ctx->sink, lane, &first);
}
