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
    const struct light_ahead *ahead[WIDE_LANES];
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

static uint32_t sample_lights(const struct world *w, const struct vertices *v, uint32_t wanted,
                              const struct shading *at, struct light_lanes *out) {
    wide u[2], choice[2] = {{0}, {0}};
    draw(v, DRAW_LIGHT_POINT, u);
    if (w->choice.draws)
        draw(v, DRAW_LIGHT, choice);
    return world_sample_lights(w, wanted, &at->s.p, &at->side, choice[0], u, out);
}

// vertex_sample_light and path_vertex.c's sample_light: leaves shadow tests pending.
static void light(const struct path *p, struct trace_context *ctx, struct vertices *v,
                  uint32_t wanted, const struct shading *at) {
    struct light_lanes l;
    wide pdf, tmax;
    struct wide3 o, d;
    uint32_t lit = v->has_ahead ? path_lights_ahead(ctx->world, v->ahead, wanted, &l)
                                : sample_lights(ctx->world, v, wanted, at, &l);
    if (!lit)
        return;
    const struct wide3 wi = into_frame(at, l.s.wi);
    const struct wide3 f = v->kind->eval(&at->closures, &wi, &pdf);
    const wide share = wide_select(wide_mask_of(l.delta), wide_of(1), mis_weights(l.s.pdf_sa, pdf));
    const wide scale = share / l.s.pdf_sa;
    lit &= ~wide_bits(wide_is_black(f));
    for (uint32_t left = ctx->world->links ? lit : 0; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        if (!world_links(ctx->world, l.light[i], v->hit[i]->shape))
            lit &= ~(1u << i);
    }
    if (p->strict_normals)
        lit &= wide_bits(wide_dot(l.s.wi, at->s.ng) * wide_dot(l.s.wi, at->s.frame.n) > 0);
    const struct wide3 weight = {f.x * scale * v->beta.x, f.y * scale * v->beta.y,
                                 f.z * scale * v->beta.z};
    world_shadow_rays(&at->s, &l.s, &o, &d, &tmax);
    scatter3(v, offsetof(struct lane, shadow.ray.o), o);
    scatter3(v, offsetof(struct lane, shadow.ray.d), d);
    scatter3(v, offsetof(struct lane, shadow.contribution.weight), weight);
    scatter3(v, offsetof(struct lane, shadow.contribution.wi), l.s.wi);
    for (; lit; lit &= lit - 1) {
        const int i = __builtin_ctz(lit);
        struct lane *to = v->lane[i];
        struct contribution *c = &to->shadow.contribution;
        c->emission = l.emission[i];
        c->source = l.light[i];
        to->shadow.late = l.late >> i & 1;
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
        v->ahead[i] = &step->lights[from];
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
