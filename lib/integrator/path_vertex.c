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

// Light sample k of so many: what it would bring to the vertex.
static void sample_candidate(const struct path *p, struct trace_context *ctx, struct lane *l,
                             const struct surface *s, const struct closure *closure, vec3 side,
                             const struct lights_ahead *ahead, uint32_t k, uint32_t count,
                             struct shadow_test *test) {
    test->pending = false;
    if (!ahead) {
        float choice = ctx->world->choice.draws ? sampler_1d(draw(l, DRAW_LIGHT)) : 0;
        struct vec2 point = sampler_2d(draw(l, DRAW_LIGHT_POINT));
        if (k > 0) {
            const struct candidate_shift by = candidate_shift(k, count);
            choice = candidate_number(choice, by.choice);
            point = (struct vec2){candidate_number(point.x, by.x), candidate_number(point.y, by.y)};
        }
        vertex_sample_light(ctx, s, closure, side, choice, point, 1, test);
    } else if (path_candidate(*ahead, k)->pdf_sa > 0) {
        const struct light_sample one = path_light_ahead(ctx->world, path_candidate(*ahead, k));
        vertex_test_light(ctx, s, closure, 0, &one, 1, test);
    }
    const vec3 wi = test->pending ? test->contribution.wi : v3(0, 0, 0);
    if (test->pending && p->strict_normals)
        test->pending = same_side(s, wi, to_local(&s->point.frame, wi));
    if (!test->pending || !test->late || !path_compares_lights(ctx->world, count))
        return;
    test->contribution.emission =
        light_late_emission(&ctx->world->lights[test->contribution.source], wi);
    test->late = false;
    test->pending = !spectrum_is_black(test->contribution.emission);
}

// Leaves in l->shadow the candidate that is to be traced, standing for all.
static void choose_candidate(const struct path *p, struct trace_context *ctx, struct lane *l,
                             const struct surface *s, const struct closure *closure, vec3 side,
                             const struct lights_ahead *ahead, uint32_t count) {
    struct shadow_test *kept = &l->shadow, one;
    struct candidates_seen seen = {0, sampler_1d(draw(l, DRAW_CANDIDATE))};
    float of_kept = 0;
    for (uint32_t k = 0; k < count; k++) {
        sample_candidate(p, ctx, l, s, closure, side, ahead, k, count, &one);
        const float value = one.pending ? shadow_test_value(&one) : 0;
        if (!candidate_takes(&seen, value))
            continue;
        *kept = one;
        of_kept = value;
    }
    kept->pending = of_kept > 0;
    if (kept->pending)
        kept->contribution.weight *= seen.sum / (of_kept * (float)count);
}

// Next event estimation: leaves a shadow test pending.
static void sample_light(const struct path *p, struct trace_context *ctx, struct lane *l,
                         const struct surface *s, const struct closure *closure, vec3 side,
                         const struct lights_ahead *ahead) {
    const uint32_t count = path_candidates(p, ctx, closure->lobes);
    struct shadow_test *kept = &l->shadow;
    if (count > 1)
        choose_candidate(p, ctx, l, s, closure, side, ahead, count);
    else
        sample_candidate(p, ctx, l, s, closure, side, ahead, 0, 1, kept);
    if (!kept->pending)
        return;
    struct contribution *c = &kept->contribution;
    if (p->max_depth >= 0)
        kept->most_passes = p->max_depth - 2 - (int)l->events;
    c->weight *= l->beta;
    c->depth = l->from.depth + 1;
    c->lobe = l->from.depth ? l->from.lobe : closure->lobes;
}

void path_shade_surface(const struct path *p, struct trace_context *ctx, struct lane *l,
                        const struct surface *s, const struct lights_ahead *ahead) {
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
