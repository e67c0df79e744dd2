// SPDX-License-Identifier: Apache-2.0
// A vertex of one path: emission found, light sampled, direction chosen.
#include "integrator/path.h"

static struct sampler *draw(struct lane *l, uint32_t purpose) {
    l->sampler.dimension = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * l->events + purpose;
    return &l->sampler;
}

// Whether shading and geometric normal agree on which side w (local wl) is.
static bool same_side(const struct surface *s, vec3 w, vec3 wl) {
    return dot(w, s->ng) * cos_theta(wl) > 0;
}

void path_leave_scene(const struct path *p, struct trace_context *ctx, struct lane *l) {
    l->alive = false;
    if (l->from.depth > 0 || !p->hide_emitters)
        vertex_add_infinite(ctx, l->sample, l->ray.d, l->beta, &l->from);
}

// First non-null event of the path: coverage and the layers of what is seen first.
static void first_event(struct trace_context *ctx, struct lane *l, const struct surface *s,
                        const struct closure *closure) {
    l->first_done = true;
    ctx->sink->type->covered(ctx->sink, l->sample);
    if (ctx->sink->wants_surface)
        vertex_add_first(ctx, l->sample, s, closure);
}

static void survive_roulette(const struct path *p, struct lane *l) {
    if (l->from.depth < (uint32_t)p->rr_depth)
        return;
    const float q = roulette_chance(l->beta, l->scale, 0.95f);
    if (sampler_1d(draw(l, DRAW_ROULETTE)) < q)
        l->beta /= q;
    else
        l->alive = false;
}

// The surface is not there: direction and origin stay.
static void pass_through(struct lane *l, const struct surface *s, const struct bsdf_sample *b) {
    l->beta *= b->weight;
    l->ray.o = surface_offset(s, l->ray.d);
    l->ray.tmin = 0;
    l->ray.tmax = INFINITY;
}

// Continues the path along a sampled direction, or ends it.
static void scatter(const struct path *p, struct lane *l, const struct surface *s, vec3 side,
                    const struct bsdf_sample *b) {
    const vec3 wi = to_world(&s->point.frame, b->wi);
    if (p->strict_normals && !same_side(s, wi, b->wi)) {
        l->alive = false;
        return;
    }
    l->beta *= b->weight;
    l->scale *= b->eta * b->eta;
    const uint32_t first_lobe = l->from.depth == 0 ? b->lobe : l->from.lobe;
    l->from = (struct path_origin){s->p, b->pdf_sa, (b->lobe & LOBE_DELTA) != 0, l->from.depth + 1,
                                   first_lobe, side, s->shape + 1};
    l->ray = (struct ray){surface_offset(s, wi), wi, 0, INFINITY};
    l->alive = !spectrum_is_black(l->beta);
    if (l->alive)
        survive_roulette(p, l);
}

static void sample_one_light(struct trace_context *ctx, struct lane *l, const struct surface *s,
                             const struct closure *closure, vec3 side) {
    const float choice = ctx->world->choice.draws ? sampler_1d(draw(l, DRAW_LIGHT)) : 0;
    const struct vec2 point = sampler_2d(draw(l, DRAW_LIGHT_POINT));
    vertex_sample_light(ctx, s, closure, side, choice, point, 1, &l->shadow);
}

// Next event estimation: leaves a shadow test pending. ahead: the sample, NULL where it is not known.
static void sample_light(const struct path *p, struct trace_context *ctx, struct lane *l,
                         const struct surface *s, const struct closure *closure, vec3 side,
                         const struct light_ahead *ahead) {
    if (!ahead)
        sample_one_light(ctx, l, s, closure, side);
    else if (ahead->pdf_sa > 0) {
        const struct light_sample one = path_light_ahead(ctx->world, ahead);
        vertex_test_light(ctx, s, closure, 0, &one, 1, &l->shadow);
    }
    struct contribution *c = &l->shadow.contribution;
    if (!l->shadow.pending)
        return;
    if (p->max_depth >= 0)
        l->shadow.most_passes = p->max_depth - 2 - (int)l->events;
    if (p->strict_normals && !same_side(s, c->wi, to_local(&s->point.frame, c->wi)))
        l->shadow.pending = false;
    c->weight *= l->beta;
    c->depth = l->from.depth + 1;
    c->lobe = l->from.depth ? l->from.lobe : closure->lobes;
}

void path_shade_surface(const struct path *p, struct trace_context *ctx, struct lane *l,
                        const struct surface *s, const struct light_ahead *ahead) {
    struct bsdf_sample b = {.lobe = 0};
    if (l->from.depth > 0 || !p->hide_emitters)
        vertex_add_emission(ctx, l->sample, s, l->ray.d, l->beta, &l->from);
    const vec3 wo = to_local(&s->point.frame, -l->ray.d);
    const struct closure *closure = response_resolve(ctx, l->sample, l->from.depth, s, wo);
    const bool goes_on = closure && path_may_contribute(p, l->events + 1) &&
                         (!p->strict_normals || same_side(s, -l->ray.d, wo));
    const vec3 side = goes_on ? vertex_light_side(s, closure, wo) : v3(0, 0, 0);
    if (goes_on && closure->lobes & LOBE_SMOOTH)
        sample_light(p, ctx, l, s, closure, side, ahead);
    l->alive = false;
    if (goes_on) {
        const float lobe = sampler_1d(draw(l, DRAW_LOBE));
        l->alive = closure_sample(closure, lobe, sampler_2d(draw(l, DRAW_DIRECTION)), &b);
    }
    if (!l->first_done && !(b.lobe & LOBE_NULL))
        first_event(ctx, l, s, closure);
    if (l->alive && b.lobe & LOBE_NULL)
        pass_through(l, s, &b);
    else if (l->alive)
        scatter(p, l, s, side, &b);
    if (++l->events >= INTEGRATOR_MOST_EVENTS && l->alive) {
        l->alive = false;
        ctx->truncated++;
    }
}
