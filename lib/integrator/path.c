// SPDX-License-Identifier: Apache-2.0
// Path tracing (Kajiya 1986) with next event estimation, multiple importance sampling (Veach and
// Guibas 1995) and Russian roulette.
//
// Sixteen paths advance together, vertex by vertex, so that the rays that run side by side, those of
// the camera and the first shadow rays, are traced as packets; later ones are single.
#include "integrator/vertex.h"

struct path {
    int max_depth, rr_depth;
    bool hide_emitters, strict_normals;
    int light_choice;
};

static const struct param params[] = {
    {"max_depth", PARAM_INT, offsetof(struct path, max_depth), .def = "-1", .min = -1, .max = 1e6,
     .unit = "", .help = "most edges of a path: 1 sees emitters, 2 adds direct light; -1: no limit"},
    {"rr_depth", PARAM_INT, offsetof(struct path, rr_depth), .def = "5", .min = 1, .max = 1e6,
     .unit = "", .help = "edges after which Russian roulette may end a path"},
    {"hide_emitters", PARAM_BOOL, offsetof(struct path, hide_emitters), .def = "false", .unit = "",
     .help = "do not show lights that are seen directly"},
    {"strict_normals", PARAM_BOOL, offsetof(struct path, strict_normals), .def = "false",
     .unit = "", .help = "drop directions on which shading and geometric normal disagree"},
    INTEGRATOR_LIGHT_CHOICE(struct path, light_choice),
    INTEGRATOR_IGNORED,
    PARAM_END,
};

static bool prepare(struct object *self, struct integrator_wants *wants) {
    wants->light_choice = (enum light_choice_mode)((const struct path *)self->data)->light_choice;
    return true;
}

// Dimensions of the random numbers: those of the camera, then so many for each vertex, whether or
// not it needs them all, so that each purpose keeps its own well-distributed points.
enum {
    CAMERA_DIMENSIONS = 4,
    VERTEX_DIMENSIONS = 8,
    DRAW_LIGHT_POINT = 0,
    DRAW_DIRECTION = 2,
    DRAW_LIGHT = 4,
    DRAW_LOBE = 5,
    DRAW_ROULETTE = 6,
};

enum { LEAST_IN_PACKET = 4 }; // rays: fewer are faster one by one

struct lane {
    struct ray ray;
    spectrum beta;
    float eta2; // product of the squared relative indices crossed: refraction's radiance scaling
    struct path_origin from;
    struct sampler sampler;
    struct shadow_test shadow;
    uint32_t events; // vertices, null ones included
    bool alive, first_done;
};

static struct sampler *draw(struct lane *l, uint32_t purpose) {
    l->sampler.dimension = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * l->events + purpose;
    return &l->sampler;
}

// Whether shading and geometric normal agree on which side w (local wl) is.
static bool same_side(const struct surface *s, vec3 w, vec3 wl) {
    return dot(w, s->ng) * cos_theta(wl) > 0;
}

static bool may_contribute(const struct path *p, uint32_t edges) {
    return p->max_depth < 0 || edges < (uint32_t)p->max_depth;
}

static void leave_scene(const struct path *p, struct trace_context *ctx, int i, struct lane *l) {
    l->alive = false;
    if (l->from.depth > 0 || !p->hide_emitters)
        vertex_add_infinite(ctx, i, l->ray.d, l->beta, &l->from);
}

// First non-null event of the path: coverage and the layers of what is seen first.
static void first_event(struct trace_context *ctx, int i, struct lane *l, const struct surface *s,
                        const struct closure *closure) {
    l->first_done = true;
    ctx->sink->type->covered(ctx->sink, i);
    if (ctx->sink->wants_surface)
        vertex_add_first(ctx, i, s, closure);
}

static void survive_roulette(const struct path *p, struct lane *l) {
    if (l->from.depth < (uint32_t)p->rr_depth)
        return;
    const float q = minf(spectrum_max(l->beta) * l->eta2, 0.95f);
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
    l->eta2 *= b->eta * b->eta;
    const uint32_t first_lobe = l->from.depth == 0 ? b->lobe : l->from.lobe;
    l->from = (struct path_origin){s->p, b->pdf_sa, (b->lobe & LOBE_DELTA) != 0, l->from.depth + 1,
                                   first_lobe, side};
    l->ray = (struct ray){surface_offset(s, wi), wi, 0, INFINITY};
    l->alive = !spectrum_is_black(l->beta);
    if (l->alive)
        survive_roulette(p, l);
}

// Next event estimation: leaves a shadow test pending.
static void sample_light(const struct path *p, struct trace_context *ctx, struct lane *l,
                         const struct surface *s, const struct closure *closure, vec3 side) {
    const float choice = ctx->world->choice.draws ? sampler_1d(draw(l, DRAW_LIGHT)) : 0;
    const struct vec2 point = sampler_2d(draw(l, DRAW_LIGHT_POINT));
    vertex_sample_light(ctx, s, closure, side, choice, point, 1, &l->shadow);
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

// One vertex: emission found, light sampled, direction chosen.
static void shade(const struct path *p, struct trace_context *ctx, int i, struct lane *l,
                  const struct accel_hit *hit) {
    struct surface s;
    struct bsdf_sample b = {.lobe = 0};
    world_surface(ctx->world, &l->ray, hit, &s);
    if (l->from.depth > 0 || !p->hide_emitters)
        vertex_add_emission(ctx, i, &s, l->ray.d, l->beta, &l->from);
    const vec3 wo = to_local(&s.point.frame, -l->ray.d);
    const struct closure *closure = response_resolve(ctx->response, &s, wo, ctx->stack);
    const bool goes_on = closure && may_contribute(p, l->events + 1) &&
                         (!p->strict_normals || same_side(&s, -l->ray.d, wo));
    const vec3 side = goes_on ? vertex_light_side(&s, closure, wo) : v3(0, 0, 0);
    if (goes_on && closure->lobes & LOBE_SMOOTH)
        sample_light(p, ctx, l, &s, closure, side);
    l->alive = false;
    if (goes_on) {
        const float lobe = sampler_1d(draw(l, DRAW_LOBE));
        l->alive = closure_sample(closure, lobe, sampler_2d(draw(l, DRAW_DIRECTION)), &b);
    }
    if (!l->first_done && !(b.lobe & LOBE_NULL))
        first_event(ctx, i, l, &s, closure);
    if (l->alive && b.lobe & LOBE_NULL)
        pass_through(l, &s, &b);
    else if (l->alive)
        scatter(p, l, &s, side, &b);
    if (++l->events >= INTEGRATOR_MOST_EVENTS && l->alive) {
        l->alive = false;
        ctx->truncated++;
    }
}

static void start(struct trace_context *ctx, struct lane *l, const struct path_start *from) {
    l->ray = from->ray;
    l->beta = spectrum_grey(1);
    l->eta2 = 1;
    l->from = (struct path_origin){.p = from->ray.o, .delta = true};
    l->sampler = from->sampler;
    l->shadow.pending = false;
    l->events = 0;
    l->alive = true;
    l->first_done = false;
    ctx->paths++;
}

// Whether the pending shadow rays run so much the same way that a packet beats single rays: packets
// were three times faster towards a small light and half as fast towards a whole sky.
static bool run_together(const struct lane lanes[SINK_LANES], uint32_t pending) {
    const float together = 0.9f; // length of the mean direction
    vec3 sum = {0};
    for (int i = 0; i < SINK_LANES; i++)
        if (pending >> i & 1)
            sum += lanes[i].shadow.contribution.wi;
    return length2(sum) > sqr(together * (float)__builtin_popcount(pending));
}

static void finish_as_packet(struct trace_context *ctx, struct lane lanes[SINK_LANES],
                             uint32_t pending, bool together) {
    struct ray rays[ACCEL_PACKET];
    for (int i = 0; i < SINK_LANES; i++)
        rays[i] = lanes[i].shadow.ray;
    const uint32_t blocked = accel_occluded16(ctx->world->accel, rays, pending, together);
    ctx->shadow_rays += (uint64_t)__builtin_popcount(pending);
    for (int i = 0; i < SINK_LANES; i++)
        if (pending >> i & 1 && !(blocked >> i & 1))
            sink_add(ctx->sink, i, &lanes[i].shadow.contribution);
}

// The shadow rays of one vertex of all lanes. Packets depend on the lanes alone, never on a clock.
static void finish_shadows(struct trace_context *ctx, struct lane lanes[SINK_LANES], bool first) {
    const struct world *w = ctx->world;
    uint32_t pending = 0;
    for (int i = 0; i < SINK_LANES; i++)
        pending |= (uint32_t)lanes[i].shadow.pending << i;
    const bool together = first && run_together(lanes, pending);
    const bool many = __builtin_popcount(pending) >= LEAST_IN_PACKET;
    if (!w->shadow_rays_may_pass && (together || (w->packets_pay && many)))
        finish_as_packet(ctx, lanes, pending, together);
    else
        for (int i = 0; i < SINK_LANES; i++)
            if (pending >> i & 1)
                vertex_finish_light(ctx, i, &lanes[i].shadow);
    for (int i = 0; i < SINK_LANES; i++)
        lanes[i].shadow.pending = false;
}

// The next hits of all living lanes: the camera's rays as a packet, later ones where that pays.
static void find_hits(struct trace_context *ctx, const struct lane lanes[SINK_LANES], bool camera,
                      struct accel_hit hits[SINK_LANES]) {
    const struct accel *accel = ctx->world->accel;
    uint32_t alive = 0;
    for (int i = 0; i < SINK_LANES; i++)
        alive |= (uint32_t)lanes[i].alive << i;
    const int count = __builtin_popcount(alive);
    ctx->rays += (uint64_t)count;
    if (camera || (ctx->world->packets_pay && count >= LEAST_IN_PACKET)) {
        struct ray rays[SINK_LANES];
        for (int i = 0; i < SINK_LANES; i++)
            rays[i] = lanes[i].ray;
        accel_intersect16(accel, rays, alive, camera, hits);
        return;
    }
    for (int i = 0; i < SINK_LANES; i++)
        if (lanes[i].alive)
            accel_intersect(accel, &lanes[i].ray, &hits[i]);
}

static void trace(const void *data, struct trace_context *ctx,
                  const struct path_start starts[SINK_LANES]) {
    const struct path *p = data;
    struct lane lanes[SINK_LANES];
    struct accel_hit hits[SINK_LANES];
    for (int i = 0; i < SINK_LANES; i++)
        start(ctx, &lanes[i], &starts[i]);
    if (!may_contribute(p, 0))
        return;
    for (bool any = true, camera = true; any; camera = false) {
        any = false;
        find_hits(ctx, lanes, camera, hits);
        for (int i = 0; i < SINK_LANES; i++) {
            struct lane *l = &lanes[i];
            if (!l->alive)
                continue;
            if (hits[i].shape == SCENE_NONE)
                leave_scene(p, ctx, i, l);
            else
                shade(p, ctx, i, l, &hits[i]);
            any |= l->alive;
        }
        finish_shadows(ctx, lanes, camera);
    }
}

const struct integrator_type integrator_path = {
    .entry = {.name = "path",
              .help = "path tracing with next event estimation and MIS (Kajiya 1986; Veach 1995)",
              .params = params, .size = sizeof(struct path)},
    .prepare = prepare, .trace = trace,
};
