// SPDX-License-Identifier: Apache-2.0
// path_vertex.c's vertex for WIDE_LANES paths that met triangles whose materials are of one kind, stage by
// stage: the operations of vertex.c, lane by lane. Emission that is found, which few lanes need,
// goes through the function for one.
#include "integrator/path.h"

_Static_assert(offsetof(struct lane, scale) == offsetof(struct lane, sampler.reversed) + 8 &&
                   offsetof(struct lane, events) == offsetof(struct lane, scale) + 4 &&
                   offsetof(struct lane, from.lobe) == offsetof(struct lane, from.pdf_sa) + 12,
               "what is gathered together lies together");

// The paths of a packet. Lanes that are not active repeat one that is, and write to `spare`.
struct vertices {
    uint32_t active;
    struct lane *lane[WIDE_LANES], *to[WIDE_LANES]; // to read, to write
    const struct accel_hit *hit[WIDE_LANES];
    struct lights_ahead ahead[WIDE_LANES];
    bool has_ahead;
    struct lane spare;
    struct wide3 d, beta;
    struct lane_state state;
    wide_uint depth, lobe;
    const struct wide_bsdf *kind;
    wide_mask two_sided;
};

// What light sampling and scattering need of the material there: world directions are turned into
// the frame, mirrored where the eye is below.
struct shading {
    struct surfaces s;
    struct wide3 side;  // the normal on the eye's side
    wide_mask below;
    struct wide_closures closures;
};

static void gather_lanes(struct vertices *v) {
    wide f[4];
    path_gather(v->lane, offsetof(struct lane, ray.d), f);
    v->d = (struct wide3){f[0], f[1], f[2]};
    path_gather(v->lane, offsetof(struct lane, beta), f);
    v->beta = (struct wide3){f[0], f[1], f[2]};
    path_gather(v->lane, offsetof(struct lane, from.pdf_sa), f); // pdf_sa, delta, depth, lobe
    v->depth = (wide_uint)f[2];
    v->lobe = (wide_uint)f[3];
    path_gather_state(v->lane, &v->state);
}

// Leaves in `points` the material's data of each lane.
static void gather_materials(const struct world *w, struct vertices *v,
                             struct wide_points *points) {
    uint32_t two_sided = 0;
    for (int i = 0; i < WIDE_LANES; i++) {
        const struct world_shape *shape = &w->shapes[v->hit[i]->shape];
        points->data[i] = shape->wide_data;
        two_sided |= (uint32_t)shape->two_sided << i;
        if (shape->textured)
            points->at[i] = world_texture_point(shape, v->hit[i]);
    }
    v->two_sided = wide_mask_of(two_sided);
}

static void draw(const struct vertices *v, uint32_t purpose, wide u[2]) {
    path_draw(v->lane, &v->state, purpose, u);
}

// Lanes that have hit a light which counts; what the densities will need is sent for.
static uint32_t find_emission(const struct world *w, const struct path *p,
                              const struct vertices *v) {
    uint32_t found = 0, from[WIDE_LANES], triangles[WIDE_LANES];
    int n = 0;
    for (uint32_t left = v->active; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const uint32_t light = w->shapes[v->hit[i]->shape].light;
        const struct lane *l = v->lane[i];
        if (light == SCENE_NONE || (l->from.depth == 0 && p->hide_emitters))
            continue;
        found |= 1u << i;
        from[n] = light;
        triangles[n] = v->hit[i]->primitive;
        n += !l->from.delta;
    }
    world_prefetch_lights(w, from, triangles, n);
    return found;
}

static void add_emission(struct trace_context *ctx, const struct path *p, const struct vertices *v,
                         const struct surfaces *s) {
    for (uint32_t left = find_emission(ctx->world, p, v); left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const struct world_shape *shape = &ctx->world->shapes[v->hit[i]->shape];
        const struct lane *l = v->lane[i];
        const struct surface one = {.p = wide3_lane(&s->p, i), .ng = wide3_lane(&s->ng, i),
                                    .light = shape->light,
                                    .point.at = world_texture_point(shape, v->hit[i])};
        vertex_add_emission(ctx, l->sample, &one, l->ray.d, l->beta, &l->from);
    }
}

// mis_weight
static wide mis_weights(wide pdf, wide other) {
    const wide r = other / pdf, none = {0};
    return wide_select(wide_both(pdf > 0, r < 1e15f), 1 / (1 + r * r), none);
}

static void scatter3(struct vertices *v, size_t offset, struct wide3 in) {
    float *row[WIDE_LANES];
    const wide f[4] = {in.x, in.y, in.z, (wide){0}};
    for (int i = 0; i < WIDE_LANES; i++) {
        row[i] = (float *)(void *)((char *)v->to[i] + offset);
    }
    wide_scatter4(f, row);
}

static struct wide3 into_frame(const struct shading *at, struct wide3 w) {
    struct wide3 local = wide_to_local(&at->s.frame, w);
    local.z = wide_negate(at->below, local.z);
    return local;
}

// Light samples of the lanes, and what they bring before the path's own throughput.
struct lit {
    uint32_t lanes; // those that are lit
    struct light_lanes l;
    struct wide3 weight;
};

static uint32_t sample_ahead(const struct world *w, const struct vertices *v, uint32_t wanted,
                             uint32_t k, struct light_lanes *out) {
    const struct light_ahead *ahead[WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++)
        ahead[i] = path_candidate(v->ahead[i], k);
    return path_lights_ahead(w, ahead, wanted, out);
}

static uint32_t sample_lights(const struct world *w, const struct vertices *v, uint32_t wanted,
                              const struct shading *at, uint32_t k, uint32_t count,
                              struct light_lanes *out) {
    wide u[2], choice[2] = {{0}, {0}};
    draw(v, DRAW_LIGHT_POINT, u);
    if (w->choice.draws)
        draw(v, DRAW_LIGHT, choice);
    if (k > 0) {
        const struct candidate_shift shift = candidate_shift(k, count);
        u[0] = candidate_numbers(u[0], shift.x);
        u[1] = candidate_numbers(u[1], shift.y);
        choice[0] = candidate_numbers(choice[0], shift.choice);
    }
    return world_sample_lights(w, wanted, &at->s.p, &at->side, choice[0], u, out);
}

static void ask_for_emission(const struct world *w, struct lit *c) {
    for (uint32_t left = c->lanes & c->l.late; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        c->l.emission[i] = light_late_emission(&w->lights[c->l.light[i]], wide3_lane(&c->l.s.wi, i));
        if (spectrum_is_black(c->l.emission[i]))
            c->lanes &= ~(1u << i);
    }
    c->l.late = 0;
}

// path_vertex.c's sample_candidate
static void sample_candidate(const struct path *p, const struct world *w, const struct vertices *v,
                             uint32_t wanted, const struct shading *at, uint32_t k, uint32_t count,
                             struct lit *out) {
    struct light_lanes *l = &out->l;
    wide pdf;
    out->lanes = v->has_ahead ? sample_ahead(w, v, wanted, k, l)
                              : sample_lights(w, v, wanted, at, k, count, l);
    if (!out->lanes)
        return;
    const struct wide3 wi = into_frame(at, l->s.wi);
    const struct wide3 f = v->kind->eval(&at->closures, &wi, &pdf);
    const wide share =
        wide_select(wide_mask_of(l->delta), wide_of(1), mis_weights(l->s.pdf_sa, pdf));
    const wide scale = share / l->s.pdf_sa;
    out->lanes &= ~wide_bits(wide_is_black(f));
    for (uint32_t left = w->links ? out->lanes : 0; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        if (!world_links(w, l->light[i], v->hit[i]->shape))
            out->lanes &= ~(1u << i);
    }
    if (p->strict_normals)
        out->lanes &= wide_bits(wide_dot(l->s.wi, at->s.ng) * wide_dot(l->s.wi, at->s.frame.n) > 0);
    out->weight = (struct wide3){f.x * scale, f.y * scale, f.z * scale};
    if (path_compares_lights(w, count))
        ask_for_emission(w, out);
}

// shadow_test_value; 0 in lanes that are not lit.
static wide value_of(const struct lit *c) {
    const float *row[WIDE_LANES];
    const wide none = {0}, density = c->l.s.pdf_sa;
    const wide_mask late = wide_mask_of(c->l.late);
    wide e[4];
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = (const float *)(const void *)&c->l.emission[i];
    wide_gather4(row, e);
    for (int k = 0; k < 3; k++)
        e[k] = wide_select(late, density, e[k]);
    const wide value = 0.212671f * (c->weight.x * e[0]) + 0.715160f * (c->weight.y * e[1]) +
                       0.072169f * (c->weight.z * e[2]);
    return wide_select(wide_mask_of(c->lanes), value, none);
}

static void keep_candidates(wide_mask takes, const struct lit *from, struct lit *to) {
    light_lanes_merge(wide_bits(takes), &from->l, &to->l);
    to->weight = wide3_select(takes, from->weight, to->weight);
}

// path_vertex.c's sample_light, as far as the sample and its weight go.
static void choose_candidates(const struct path *p, const struct trace_context *ctx,
                              const struct vertices *v, uint32_t wanted, const struct shading *at,
                              struct lit *kept) {
    const uint32_t count = path_candidates(p, ctx, v->kind->lobes);
    struct candidates_seen_wide seen = {{0}, {0}};
    struct lit one;
    wide u[2];
    sample_candidate(p, ctx->world, v, wanted, at, 0, count, kept);
    if (count == 1)
        return;
    draw(v, DRAW_CANDIDATE, u);
    seen.u = u[0];
    const wide first = kept->lanes ? value_of(kept) : wide_of(0), none = {0};
    wide of_kept = wide_select(candidates_take(&seen, first), first, none);
    for (uint32_t k = 1; k < count; k++) {
        sample_candidate(p, ctx->world, v, wanted, at, k, count, &one);
        if (!one.lanes)
            continue;
        const wide value = value_of(&one);
        const wide_mask takes = candidates_take(&seen, value);
        keep_candidates(takes, &one, kept);
        of_kept = wide_select(takes, value, of_kept);
    }
    const wide factor = seen.sum / (of_kept * (float)count);
    kept->weight = (struct wide3){kept->weight.x * factor, kept->weight.y * factor,
                                  kept->weight.z * factor};
    kept->lanes = wide_bits(of_kept > 0);
}

// vertex_sample_light and path_vertex.c's sample_light: leaves shadow tests pending.
static void light(const struct path *p, struct trace_context *ctx, struct vertices *v,
                  uint32_t wanted, const struct shading *at) {
    struct lit kept;
    wide tmax;
    struct wide3 o, d;
    choose_candidates(p, ctx, v, wanted, at, &kept);
    if (!kept.lanes)
        return;
    const struct wide3 weight = {kept.weight.x * v->beta.x, kept.weight.y * v->beta.y,
                                 kept.weight.z * v->beta.z};
    world_shadow_rays(&at->s, &kept.l.s, &o, &d, &tmax);
    scatter3(v, offsetof(struct lane, shadow.ray.o), o);
    scatter3(v, offsetof(struct lane, shadow.ray.d), d);
    scatter3(v, offsetof(struct lane, shadow.contribution.weight), weight);
    scatter3(v, offsetof(struct lane, shadow.contribution.wi), kept.l.s.wi);
    for (uint32_t lit = kept.lanes; lit; lit &= lit - 1) {
        const int i = __builtin_ctz(lit);
        struct lane *to = v->lane[i];
        struct contribution *c = &to->shadow.contribution;
        c->emission = kept.l.emission[i];
        c->source = kept.l.light[i];
        to->shadow.late = kept.l.late >> i & 1;
        if (!to->shadow.late && spectrum_is_black(c->emission))
            continue;
        c->depth = v->depth[i] + 1;
        c->lobe = v->depth[i] ? v->lobe[i] : v->kind->lobes;
        c->sampled = true;
        to->shadow.ray.tmin = 0;
        to->shadow.ray.tmax = tmax[i];
        to->shadow.most_passes = p->max_depth < 0 ? -1 : p->max_depth - 2 - (int)v->state.events[i];
        to->shadow.pending = true;
    }
}

// Paths that go on after Russian roulette; beta is divided by the chance of doing so.
static uint32_t survive(const struct path *p, const struct vertices *v, uint32_t alive,
                        wide_uint depth, struct wide3 *beta) {
    const wide_mask plays = (wide_mask)(depth >= (uint32_t)p->rr_depth);
    if (!(alive & wide_bits(plays)))
        return alive;
    const wide most = wide_max(beta->x, wide_max(beta->y, beta->z));
    const wide q = wide_min(2 * most * v->state.scale, wide_of(0.95f)); // as roulette_chance
    wide u[2];
    draw(v, DRAW_ROULETTE, u);
    const wide divisor = wide_select(plays, q, wide_of(1));
    *beta = (struct wide3){beta->x / divisor, beta->y / divisor, beta->z / divisor};
    return alive & wide_bits(~plays | (u[0] < q));
}

// closure_sample and path_vertex.c's scatter.
static uint32_t scatter(const struct path *p, struct vertices *v, uint32_t wanted,
                        const struct shading *at) {
    wide u[2], choice[2] = {{0}, {0}};
    struct wide_samples b;
    if (v->kind->draws_lobe)
        draw(v, DRAW_LOBE, choice);
    draw(v, DRAW_DIRECTION, u);
    uint32_t alive = wanted & wide_bits(v->kind->sample(&at->closures, choice[0], u, &b));
    b.wi.z = wide_negate(at->below, b.wi.z);
    const struct wide3 wi = wide_to_world(&at->s.frame, b.wi);
    if (p->strict_normals)
        alive &= wide_bits(wide_dot(wi, at->s.ng) * b.wi.z > 0);
    struct wide3 beta = {v->beta.x * b.weight.x, v->beta.y * b.weight.y, v->beta.z * b.weight.z};
    alive &= ~wide_bits(wide_is_black(beta));
    const wide_uint depth = v->depth + 1;
    alive = survive(p, v, alive, depth, &beta);
    scatter3(v, offsetof(struct lane, beta), beta);
    scatter3(v, offsetof(struct lane, ray.o), surfaces_offset(&at->s, wi));
    scatter3(v, offsetof(struct lane, ray.d), wi);
    scatter3(v, offsetof(struct lane, from.p), at->s.p);
    scatter3(v, offsetof(struct lane, from.n), at->side);
    for (uint32_t left = alive; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        struct lane *l = v->lane[i];
        l->from.lobe = v->depth[i] ? v->lobe[i] : b.lobe[i];
        l->from.pdf_sa = b.pdf_sa[i];
        l->from.delta = false;
        l->from.depth = depth[i];
        l->from.receiver = v->hit[i]->shape + 1;
        l->ray.tmin = 0;
        l->ray.tmax = INFINITY;
    }
    return alive;
}

static void choose(struct vertices *v, struct lane *lanes, const struct packet *packet,
                   const struct step *step) {
    v->has_ahead = step->ahead;
    v->active = (1u << packet->count) - 1;
    for (int i = 0; i < WIDE_LANES; i++) {
        const uint16_t from = packet->lanes[i < packet->count ? i : 0];
        v->lane[i] = &lanes[from];
        v->to[i] = i < packet->count ? v->lane[i] : &v->spare;
        v->hit[i] = &step->hits[from];
        v->ahead[i] = path_lights_of(step, from);
    }
}

// Lanes that may go on from here: seen from a side that the material has.
static uint32_t look(const struct path *p, const struct vertices *v, struct wide3 back,
                     struct shading *at) {
    const wide up = wide_dot(back, at->s.frame.n);
    at->below = wide_whole(up < 0);
    at->side = wide3_negate(at->below, at->s.frame.n);
    uint32_t goes_on = v->active & wide_bits(wide_whole(up > 0) | (at->below & v->two_sided));
    if (p->max_depth >= 0)
        goes_on &= wide_bits((wide_mask)(v->state.events + 1 < (uint32_t)p->max_depth));
    if (p->strict_normals)
        goes_on &= wide_bits(wide_dot(back, at->s.ng) * up > 0);
    return goes_on;
}

// For a response that keeps account of the path, and may have data of its own.
static void note_vertices(struct trace_context *ctx, const struct vertices *v,
                          const struct packet *packet, struct wide_points *points) {
    for (int i = 0; i < packet->count; i++) {
        const void *data = ctx->response->note(ctx->response, ctx, v->lane[i]->sample,
                                               v->lane[i]->from.depth, v->hit[i]->shape);
        points->data[i] = data ? data : points->data[i];
    }
    for (int i = packet->count; i < WIDE_LANES; i++)
        points->data[i] = points->data[0];
}

void path_shade_wide(const struct path *p, struct trace_context *ctx, struct lane *lanes,
                     const struct packet *packet, const struct step *step, uint32_t kind) {
    struct vertices v;
    struct shading at;
    struct wide_points points;
    uint32_t alive = 0;
    choose(&v, lanes, packet, step);
    v.kind = kind == KIND_OWN ? ctx->response->own : ctx->world->wide_kinds[kind];
    gather_lanes(&v);
    gather_materials(ctx->world, &v, &points);
    world_surfaces(ctx->world, v.hit, &at.s);
    add_emission(ctx, p, &v, &at.s);
    if (ctx->response->note)
        note_vertices(ctx, &v, packet, &points);
    const struct wide3 back = {-v.d.x, -v.d.y, -v.d.z};
    const uint32_t goes_on = look(p, &v, back, &at);
    if (goes_on) {
        const struct wide3 wo = into_frame(&at, back);
        v.kind->resolve(&points, &wo, &at.closures);
        light(p, ctx, &v, goes_on, &at);
        alive = scatter(p, &v, goes_on, &at);
    }
    for (uint32_t left = v.active; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        struct lane *l = v.lane[i];
        l->alive = alive >> i & 1;
        if (!l->first_done)
            ctx->sink->type->covered(ctx->sink, l->sample);
        l->first_done = true;
        if (++l->events >= INTEGRATOR_MOST_EVENTS && l->alive) {
            l->alive = false;
            ctx->truncated++;
        }
    }
}
