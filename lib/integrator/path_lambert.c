// SPDX-License-Identifier: Apache-2.0
// path.c's vertex for sixteen paths that met Lambertian triangles, stage by stage: the operations of
// vertex.c and of bsdf/diffuse.c, lane by lane. What few lanes need (emission that is found, lights
// of other kinds) goes through the functions for one.
#include "integrator/path.h"

_Static_assert(offsetof(struct lane, eta2) == offsetof(struct lane, sampler.reversed) + 8 &&
                   offsetof(struct lane, events) == offsetof(struct lane, eta2) + 4 &&
                   offsetof(struct lane, from.lobe) == offsetof(struct lane, from.pdf_sa) + 12,
               "what is gathered together lies together");

// The paths of a packet. Lanes that are not active repeat one that is, and write to `spare`.
struct vertices {
    uint32_t active;
    struct lane *lane[WIDE_LANES], *to[WIDE_LANES]; // to read, to write
    const struct accel_hit *hit[WIDE_LANES];
    struct lane spare;
    struct wide3 d, beta;
    wide eta2;
    wide_uint depth, lobe, events;
    struct sampler_lanes sampler;
    struct wide3 reflectance;
    wide_mask two_sided;
};


// Four numbers of each lane, at an offset in struct lane.
static void gather(const struct vertices *v, size_t offset, wide f[4]) {
    const float *row[WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = (const float *)(const void *)((const char *)v->lane[i] + offset);
    wide_gather4(row, f);
}

static void gather_lanes(struct vertices *v) {
    wide f[4];
    gather(v, offsetof(struct lane, ray.d), f);
    v->d = (struct wide3){f[0], f[1], f[2]};
    gather(v, offsetof(struct lane, beta), f);
    v->beta = (struct wide3){f[0], f[1], f[2]};
    gather(v, offsetof(struct lane, from.pdf_sa), f); // pdf_sa, delta, depth, lobe
    v->depth = (wide_uint)f[2];
    v->lobe = (wide_uint)f[3];
    gather(v, offsetof(struct lane, sampler.seed), f); // seed, index, count, dimension
    v->sampler.seed = (wide_uint)f[0];
    v->sampler.index = (wide_uint)f[1];
    gather(v, offsetof(struct lane, sampler.reversed), f); // reversed, padding, eta2, events
    v->sampler.reversed = (wide_uint)f[0];
    v->eta2 = f[2];
    v->events = (wide_uint)f[3];
}

static void gather_materials(const struct world *w, struct vertices *v) {
    const float *row[WIDE_LANES];
    spectrum textured[WIDE_LANES];
    wide f[4];
    uint32_t two_sided = 0;
    for (int i = 0; i < WIDE_LANES; i++) {
        const struct world_shape *shape = &w->shapes[v->hit[i]->shape];
        const struct texture_ref *r = shape->reflectance;
        row[i] = (const float *)(const void *)&r->value;
        two_sided |= (uint32_t)shape->two_sided << i;
        if (r->texture) {
            const struct texture_point at = world_texture_point(shape, v->hit[i]);
            textured[i] = texture_eval(r, &at);
            row[i] = (const float *)(const void *)&textured[i];
        }
    }
    wide_gather4(row, f);
    v->reflectance = (struct wide3){f[0], f[1], f[2]};
    v->two_sided = wide_mask_of(two_sided);
}

static void draw(const struct vertices *v, uint32_t purpose, wide u[2]) {
    const bool pair = purpose == DRAW_LIGHT_POINT || purpose == DRAW_DIRECTION;
    const wide_uint dimension = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * v->events + purpose;
    const struct sampler_type *type = v->lane[0]->sampler.type;
    if (type->draw_wide) {
        type->draw_wide(&v->sampler, dimension, u);
        return;
    }
    for (int i = 0; i < WIDE_LANES; i++) {
        struct sampler s = v->lane[i]->sampler;
        s.dimension = dimension[i];
        const struct vec2 one = pair ? sampler_2d(&s) : (struct vec2){sampler_1d(&s), 0};
        u[0][i] = one.x;
        u[1][i] = one.y;
    }
}

static void add_emission(struct trace_context *ctx, const struct path *p, const struct vertices *v,
                         const struct packet *packet, const struct surfaces *s) {
    for (uint32_t left = v->active; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const struct world_shape *shape = &ctx->world->shapes[v->hit[i]->shape];
        const struct lane *l = v->lane[i];
        if (shape->light == SCENE_NONE || (l->from.depth == 0 && p->hide_emitters))
            continue;
        const struct surface one = {.p = wide3_lane(&s->p, i), .ng = wide3_lane(&s->ng, i),
                                    .light = shape->light,
                                    .point.at = world_texture_point(shape, v->hit[i])};
        vertex_add_emission(ctx, packet->lanes[i], &one, l->ray.d, l->beta, &l->from);
    }
}

// Of one light for all lanes, or of each lane's own.
struct light_lanes {
    struct light_samples s;
    spectrum emission[WIDE_LANES];
    uint32_t light[WIDE_LANES];
    uint32_t late;
    bool shared; // the light with index 0, and s.emission, are those of all
};

static void set_sample(struct light_lanes *out, int i, const struct light_sample *l) {
    wide3_set_lane(&out->s.wi, i, l->wi);
    wide3_set_lane(&out->s.p, i, l->p);
    wide3_set_lane(&out->s.p_error, i, l->p_error);
    wide3_set_lane(&out->s.n, i, l->n);
    out->s.distance[i] = l->distance;
    out->s.pdf_sa[i] = l->pdf_sa;
    out->emission[i] = l->emission;
}

// Lanes that were lit by a light that a path can also find, and (in *delta) by one it cannot.
static uint32_t sample_lights(struct trace_context *ctx, const struct vertices *v, uint32_t wanted,
                              const struct surfaces *s, struct wide3 side, struct light_lanes *out,
                              uint32_t *delta) {
    const struct world *w = ctx->world;
    wide u[2], choice[2] = {{0}, {0}};
    uint32_t lit = 0;
    draw(v, DRAW_LIGHT_POINT, u);
    *delta = out->late = 0;
    if (w->light_count == 1 && !w->choice.by_part && w->lights[0].type->has_wide &&
        w->lights[0].type->has_wide(w->lights[0].data)) {
        lit = wanted & wide_bits(w->lights[0].type->sample_wide(w->lights[0].data, &s->p, u, &out->s));
        out->shared = true;
        return lit;
    }
    out->shared = false;
    if (w->choice.draws)
        draw(v, DRAW_LIGHT, choice);
    for (uint32_t left = wanted; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const struct light_place at = {wide3_lane(&s->p, i), wide3_lane(&side, i)};
        struct light_sample l;
        if (!world_sample_light(w, &at, choice[0][i], (struct vec2){u[0][i], u[1][i]},
                                &out->light[i], &l))
            continue;
        set_sample(out, i, &l);
        lit |= 1u << i;
        *delta |= (uint32_t)l.delta << i;
        out->late |= (uint32_t)l.late << i;
    }
    return lit;
}

// world_shadow_ray
static void shadow_rays(const struct surfaces *s, const struct light_samples *l, struct wide3 *o,
                        struct wide3 *d, wide *tmax) {
    *o = surfaces_offset(s, l->wi);
    const struct wide3 straight = wide3_sub(l->p, *o);
    const wide reach = 4 * 0x1p-24f * wide_largest(straight);
    const struct wide3 error = {l->p_error.x + reach, l->p_error.y + reach, l->p_error.z + reach};
    const struct wide3 back = {-l->wi.x, -l->wi.y, -l->wi.z};
    const struct wide3 target = wide_offset_point(l->p, error, l->n, back);
    const wide_mask faces = wide_dot(l->n, l->n) > 0, near = l->distance < INFINITY;
    *d = wide3_select(near, wide3_select(faces, wide3_sub(target, *o), straight), l->wi);
    *tmax = wide_select(near, wide_of(1), wide_of(INFINITY));
}

// mis_weight
static wide mis_weights(wide pdf, wide other) {
    const wide r = other / pdf, none = {0};
    return wide_select((pdf > 0) & (r < 1e15f), 1 / (1 + r * r), none);
}

static void scatter3(struct vertices *v, size_t offset, struct wide3 in) {
    float *row[WIDE_LANES];
    const wide f[4] = {in.x, in.y, in.z, (wide){0}};
    for (int i = 0; i < WIDE_LANES; i++) {
        row[i] = (float *)(void *)((char *)v->to[i] + offset);
    }
    wide_scatter4(f, row);
}

// vertex_sample_light and path.c's sample_light: leaves shadow tests pending.
static void light(const struct path *p, struct trace_context *ctx, struct vertices *v,
                  uint32_t wanted, const struct surfaces *s, struct wide3 side, wide_mask below) {
    struct light_lanes l;
    uint32_t delta;
    uint32_t lit = sample_lights(ctx, v, wanted, s, side, &l, &delta);
    const wide up = wide_dot(l.s.wi, s->frame.n);
    const wide cosine = wide_negate(below, up);
    const wide f = cosine * INV_PI; // over the reflectance; also the density
    const wide share = wide_select(wide_mask_of(delta), wide_of(1), mis_weights(l.s.pdf_sa, f));
    const wide scale = share / l.s.pdf_sa;
    struct wide3 weight = {v->reflectance.x * f, v->reflectance.y * f, v->reflectance.z * f};
    lit &= wide_bits((cosine > 0) & ((weight.x != 0) | (weight.y != 0) | (weight.z != 0)));
    if (p->strict_normals)
        lit &= wide_bits(wide_dot(l.s.wi, s->ng) * up > 0);
    weight = (struct wide3){weight.x * scale * v->beta.x, weight.y * scale * v->beta.y,
                            weight.z * scale * v->beta.z};
    struct wide3 o, d;
    wide tmax;
    shadow_rays(s, &l.s, &o, &d, &tmax);
    scatter3(v, offsetof(struct lane, shadow.ray.o), o);
    scatter3(v, offsetof(struct lane, shadow.ray.d), d);
    scatter3(v, offsetof(struct lane, shadow.contribution.weight), weight);
    scatter3(v, offsetof(struct lane, shadow.contribution.wi), l.s.wi);
    for (; lit; lit &= lit - 1) {
        const int i = __builtin_ctz(lit);
        struct lane *to = v->lane[i];
        struct contribution *c = &to->shadow.contribution;
        c->emission = l.shared ? l.s.emission : l.emission[i];
        c->source = l.shared ? 0 : l.light[i];
        to->shadow.late = l.late >> i & 1;
        if (!to->shadow.late && spectrum_is_black(c->emission))
            continue;
        c->depth = v->depth[i] + 1;
        c->lobe = v->depth[i] ? v->lobe[i] : LOBE_DIFFUSE | LOBE_REFLECTION;
        c->sampled = true;
        to->shadow.ray.tmin = 0;
        to->shadow.ray.tmax = tmax[i];
        to->shadow.most_passes = p->max_depth < 0 ? -1 : p->max_depth - 2 - (int)v->events[i];
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
    const wide q = wide_min(most * v->eta2, wide_of(0.95f));
    wide u[2];
    draw(v, DRAW_ROULETTE, u);
    const wide divisor = wide_select(plays, q, wide_of(1));
    *beta = (struct wide3){beta->x / divisor, beta->y / divisor, beta->z / divisor};
    return alive & wide_bits(~plays | (u[0] < q));
}

// closure_sample and path.c's scatter.
static uint32_t scatter(const struct path *p, struct vertices *v, uint32_t wanted,
                        const struct surfaces *s, struct wide3 side, wide_mask below) {
    wide u[2];
    draw(v, DRAW_DIRECTION, u);
    struct wide3 local = wide_cosine_hemisphere(u);
    const wide pdf = local.z * INV_PI;
    local.z = wide_negate(below, local.z);
    const struct wide3 wi = wide_to_world(&s->frame, local);
    uint32_t alive = wanted & wide_bits(pdf > 0);
    if (p->strict_normals)
        alive &= wide_bits(wide_dot(wi, s->ng) * local.z > 0);
    struct wide3 beta = {v->beta.x * v->reflectance.x, v->beta.y * v->reflectance.y,
                         v->beta.z * v->reflectance.z};
    alive &= wide_bits((beta.x != 0) | (beta.y != 0) | (beta.z != 0));
    const wide_uint depth = v->depth + 1;
    alive = survive(p, v, alive, depth, &beta);
    scatter3(v, offsetof(struct lane, beta), beta);
    scatter3(v, offsetof(struct lane, ray.o), surfaces_offset(s, wi));
    scatter3(v, offsetof(struct lane, ray.d), wi);
    scatter3(v, offsetof(struct lane, from.p), s->p);
    scatter3(v, offsetof(struct lane, from.n), side);
    for (uint32_t left = alive; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        struct lane *l = v->lane[i];
        l->from.lobe = v->depth[i] ? v->lobe[i] : LOBE_DIFFUSE | LOBE_REFLECTION;
        l->from.pdf_sa = pdf[i];
        l->from.delta = false;
        l->from.depth = depth[i];
        l->ray.tmin = 0;
        l->ray.tmax = INFINITY;
    }
    return alive;
}

static void choose(struct vertices *v, struct lane *lanes, const struct packet *packet,
                   const struct accel_hit *hits) {
    v->active = (1u << packet->count) - 1;
    for (int i = 0; i < WIDE_LANES; i++) {
        const uint16_t from = packet->lanes[i < packet->count ? i : 0];
        v->lane[i] = &lanes[from];
        v->to[i] = i < packet->count ? v->lane[i] : &v->spare;
        v->hit[i] = &hits[from];
    }
}

void path_shade_lambert(const struct path *p, struct trace_context *ctx, struct lane *lanes,
                        const struct packet *packet, const struct accel_hit *hits) {
    struct vertices v;
    struct surfaces s;
    choose(&v, lanes, packet, hits);
    gather_lanes(&v);
    gather_materials(ctx->world, &v);
    world_surfaces(ctx->world, v.hit, &s);
    add_emission(ctx, p, &v, packet, &s);
    const struct wide3 back = {-v.d.x, -v.d.y, -v.d.z};
    const wide up = wide_dot(back, s.frame.n);
    const wide_mask below = up < 0;
    const struct wide3 side = wide3_negate(below, s.frame.n);
    uint32_t goes_on = v.active & wide_bits((up > 0) | (below & v.two_sided));
    if (p->max_depth >= 0)
        goes_on &= wide_bits((wide_mask)(v.events + 1 < (uint32_t)p->max_depth));
    if (p->strict_normals)
        goes_on &= wide_bits(wide_dot(back, s.ng) * up > 0);
    light(p, ctx, &v, goes_on, &s, side, below);
    const uint32_t alive = scatter(p, &v, goes_on, &s, side, below);
    for (uint32_t left = v.active; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        struct lane *l = v.lane[i];
        l->alive = alive >> i & 1;
        if (!l->first_done)
            ctx->sink->type->covered(ctx->sink, packet->lanes[i]);
        l->first_done = true;
        if (++l->events >= INTEGRATOR_MOST_EVENTS && l->alive) {
            l->alive = false;
            ctx->truncated++;
        }
    }
}
