// SPDX-License-Identifier: Apache-2.0
// Path tracing (Kajiya 1986) with next event estimation, multiple importance sampling (Veach and
// Guibas 1995) and Russian roulette.
//
// Many paths advance together, vertex by vertex, so that rays are there to fill packets: those that
// run side by side, of the camera and the first shadow rays, and all where a scene is small.
#include "integrator/path.h"

#include <string.h>

static const struct param params[] = {
    {"max_depth", PARAM_INT, offsetof(struct path, max_depth), .def = "-1", .min = -1, .max = 1e6,
     .unit = "", .help = "most edges of a path: 1 sees emitters, 2 adds direct light; -1: no limit"},
    {"rr_depth", PARAM_INT, offsetof(struct path, rr_depth), .def = "3", .min = 1, .max = 1e6,
     .unit = "", .help = "edges after which Russian roulette may end a path"},
    {"shading_samples", PARAM_INT, offsetof(struct path, shading_samples), .def = "1", .min = 1,
     .max = MOST_SHADING_SAMPLES, .unit = "",
     .help = "paths that go on from each first hit; a sample is their mean"},
    {"hide_emitters", PARAM_BOOL, offsetof(struct path, hide_emitters), .def = "false", .unit = "",
     .help = "do not show lights that are seen directly"},
    {"strict_normals", PARAM_BOOL, offsetof(struct path, strict_normals), .def = "false",
     .unit = "", .help = "drop directions on which shading and geometric normal disagree"},
    INTEGRATOR_LIGHT_CHOICE(struct path, light_choice),
    {"light_candidates", PARAM_INT, offsetof(struct path, light_candidates), .def = "0", .min = 0,
     .max = MOST_CANDIDATES, .unit = "",
     .help = "light samples of which a glossy surface traces one, by what they would bring; 0: 3 where "
             "a sky is the only light, else 1"},
    INTEGRATOR_IGNORED,
    PARAM_END,
};

static bool prepare(struct object *self, struct integrator_wants *wants) {
    wants->light_choice = (enum light_choice_mode)((const struct path *)self->data)->light_choice;
    return true;
}

static void start(struct trace_context *ctx, struct lane *l, const struct path_start *from,
                  uint32_t sample) {
    l->sample = (uint16_t)sample;
    l->ray = from->ray;
    l->beta = spectrum_grey(1);
    l->scale = 1;
    l->from = (struct path_origin){.p = from->ray.o, .delta = true};
    l->sampler = from->sampler;
    l->events = 0;
    l->alive = true;
    l->first_done = false;
    ctx->paths++;
}

// The paths that are traced together, and which of them are still under way, ascending.
struct wave {
    struct lane lanes[MOST_LANES];
    uint16_t alive[MOST_LANES];
    uint32_t count;
};

// The packet that begins at `first` of a list. Embree's packets may return other hits when other rays
// are in them, so where it may be given one (`alike`: the rays may run side by side) these are 4x4
// blocks of pixels, always the same; else any lanes will do.
static struct packet packet_at(const struct world *w, const uint16_t *list, uint32_t count,
                               uint32_t first, bool alike) {
    struct packet p = {list + first, 0};
    const uint32_t left = count - first;
    const int most = left < SINK_LANES ? (int)left : SINK_LANES;
    if (accel_mixes_packets(w->accel) || !(alike || w->packets_pay))
        p.count = most;
    else
        while (p.count < most && p.lanes[p.count] / SINK_LANES == p.lanes[0] / SINK_LANES)
            p.count++;
    return p;
}

// Whether shadow rays run so much the same way that a packet beats single rays: packets were three
// times faster towards a small light and half as fast towards a whole sky.
static bool run_together(const struct lane *lanes, const struct packet *p) {
    const float together = 0.9f; // length of the mean direction
    vec3 sum = {0};
    for (int i = 0; i < p->count; i++)
        sum += lanes[p->lanes[i]].shadow.contribution.wi;
    return length2(sum) > sqr(together * (float)p->count);
}

// How the rays of a packet are traced: one by one, or by Embree as a packet of any rays or of such
// that run together.
enum tracing { TRACE_EACH, TRACE_ANY, TRACE_TOGETHER };

static enum tracing tracing_of(const struct world *w, const struct packet *p, bool together) {
    if (together)
        return TRACE_TOGETHER;
    const bool pays = w->packets_pay && p->count >= LEAST_IN_PACKET;
    return pays || accel_mixes_packets(w->accel) ? TRACE_ANY : TRACE_EACH;
}

static uint32_t blocked_together(const struct accel *accel, const struct lane *lanes,
                                 const struct packet *p, bool together) {
    struct ray rays[SINK_LANES];
    for (int i = 0; i < SINK_LANES; i++)
        rays[i] = lanes[p->lanes[i < p->count ? i : 0]].shadow.ray;
    return accel_occluded16(accel, rays, (1u << p->count) - 1, together);
}

// Which of the shadow rays of the lanes listed are blocked. Those that run alone are traced after the
// packets, all at once.
static void trace_shadows(const struct world *w, const struct lane *lanes, const uint16_t *list,
                          uint32_t count, bool first, bool *blocked) {
    struct ray rays[MOST_LANES];
    bool found[MOST_LANES];
    uint16_t at[MOST_LANES]; // in the list
    uint32_t alone = 0;
    struct packet p;
    for (uint32_t i = 0; i < count; i += (uint32_t)p.count) {
        p = packet_at(w, list, count, i, first);
        const bool same_way =
            first && !accel_mixes_packets(w->accel) && run_together(lanes, &p);
        const enum tracing how = tracing_of(w, &p, same_way);
        const uint32_t bits =
            how == TRACE_EACH ? 0 : blocked_together(w->accel, lanes, &p, how == TRACE_TOGETHER);
        for (uint32_t k = 0; k < (uint32_t)p.count; k++) {
            blocked[i + k] = bits >> k & 1;
            if (how != TRACE_EACH)
                continue;
            rays[alone] = lanes[p.lanes[k]].shadow.ray;
            at[alone++] = (uint16_t)(i + k);
        }
    }
    if (alone)
        accel_occluded_each(w->accel, rays, alone, found);
    for (uint32_t k = 0; k < alone; k++)
        blocked[at[k]] = found[k];
}

// The shadow rays of one vertex of the lanes listed. Packets depend on the lanes alone, never on a
// clock.
static void finish_shadows(struct trace_context *ctx, struct lane *lanes, const uint16_t *list,
                           uint32_t count, bool first) {
    bool blocked[MOST_LANES];
    if (ctx->world->shadow_rays_may_pass) {
        for (uint32_t i = 0; i < count; i++)
            vertex_finish_light(ctx, lanes[list[i]].sample, &lanes[list[i]].shadow);
        return;
    }
    trace_shadows(ctx->world, lanes, list, count, first, blocked);
    ctx->shadow_rays += count;
    for (uint32_t i = 0; i < count; i++)
        if (!blocked[i])
            vertex_add_light(ctx, lanes[list[i]].sample, &lanes[list[i]].shadow);
}

// The next hits of a packet's lanes: the camera's rays together, later ones where that pays.
static void trace_hits(struct trace_context *ctx, const struct lane *lanes, const struct packet *p,
                       bool camera, struct accel_hit *hits) {
    const struct accel *accel = ctx->world->accel;
    const enum tracing how = tracing_of(ctx->world, p, camera);
    ctx->rays += (uint64_t)p->count;
    if (how != TRACE_EACH) {
        struct ray rays[SINK_LANES];
        struct accel_hit found[SINK_LANES];
        for (int i = 0; i < SINK_LANES; i++)
            rays[i] = lanes[p->lanes[i < p->count ? i : 0]].ray;
        accel_intersect16(accel, rays, (1u << p->count) - 1, how == TRACE_TOGETHER, found);
        for (int i = 0; i < p->count; i++)
            hits[p->lanes[i]] = found[i];
        return;
    }
    for (int i = 0; i < p->count; i++)
        accel_intersect(accel, &lanes[p->lanes[i]].ray, &hits[p->lanes[i]]);
}

static void find_hits(struct trace_context *ctx, const struct lane *lanes, const struct packet *p,
                      bool camera, struct accel_hit *hits) {
    trace_hits(ctx, lanes, p, camera, hits);
    for (int i = 0; ctx->world->hides && i < p->count; i++)
        if (lanes[p->lanes[i]].from.depth == 0)
            world_see(ctx->world, &lanes[p->lanes[i]].ray, &hits[p->lanes[i]]);
    for (int i = 0; i < p->count; i++)
        world_prefetch_indices(ctx->world, &hits[p->lanes[i]]);
}

// Lanes by the kind of their material; 0: those that are shaded one by one.
struct kinds {
    uint32_t count[PATH_KINDS];
    uint16_t lanes[PATH_KINDS][MOST_LANES];
};

static void add_lane(struct kinds *k, uint32_t kind, uint16_t lane) {
    k->lanes[kind][k->count[kind]++] = lane;
}

static void shade_alone(const struct path *p, struct trace_context *ctx, struct wave *w,
                        const struct step *step, uint16_t lane) {
    const struct lights_ahead ahead = path_lights_of(step, lane);
    struct lane *l = &w->lanes[lane];
    struct surface s;
    world_surface(ctx->world, &l->ray, &step->hits[lane], &s);
    path_shade_surface(p, ctx, l, &s, step->ahead && ahead.first->pdf_sa >= 0 ? &ahead : NULL);
}

static void shade_kind(const struct path *p, struct trace_context *ctx, struct wave *w,
                       const struct step *step, uint32_t kind, struct kinds *k) {
    const uint32_t count = k->count[kind];
    const uint16_t *list = k->lanes[kind];
    // Paths of one sample add to one sum: their order may not depend on the lanes beside them.
    const uint32_t least = p->shading_samples > 1 ? 1 : LEAST_IN_PACKET;
    uint32_t done = 0;
    while (count - done >= least) {
        const uint32_t left = count - done;
        const struct packet group = {list + done, left < WIDE_LANES ? (int)left : WIDE_LANES};
        path_shade_wide(p, ctx, w->lanes, &group, step, kind);
        done += (uint32_t)group.count;
    }
    while (done < count)
        add_lane(k, KIND_ALONE, list[done++]);
}

// What comes of a vertex does not depend on other lanes, so those that shade alike go together.
static void shade_all(const struct path *p, struct trace_context *ctx, struct wave *w,
                      const struct step *step) {
    struct kinds kinds;
    memset(kinds.count, 0, sizeof kinds.count);
    for (uint32_t k = 0; k < w->count; k++) {
        const uint16_t i = w->alive[k];
        struct lane *l = &w->lanes[i];
        l->shadow.pending = false;
        if (step->hits[i].shape == SCENE_NONE) {
            path_leave_scene(p, ctx, l);
            continue;
        }
        add_lane(&kinds, path_wide_kind(ctx, l, &step->hits[i]), i);
        world_prefetch_corners(ctx->world, &step->hits[i]);
    }
    for (uint32_t kind = 1; kind < ctx->world->wide_kind_count; kind++)
        shade_kind(p, ctx, w, step, kind, &kinds);
    shade_kind(p, ctx, w, step, KIND_OWN, &kinds);
    for (uint32_t k = 0; k < kinds.count[KIND_ALONE]; k++)
        shade_alone(p, ctx, w, step, kinds.lanes[KIND_ALONE][k]);
}

// The paths of a sample. Chains, which are of one path, are not shared.
static uint32_t paths_of_sample(const struct path *p, const struct trace_context *ctx) {
    return ctx->sink->chains ? 1 : (uint32_t)p->shading_samples;
}

// Samples that run side by side: whole packets, with room for all their paths.
static uint32_t samples_of_wave(uint32_t paths) {
    return MOST_LANES / paths / SINK_LANES * SINK_LANES;
}

static void become_path(struct lane *l, uint32_t path, uint32_t paths) {
    l->beta /= (float)paths;
    l->scale *= (float)paths;
    sampler_split(&l->sampler, path, paths);
}

// From a first hit all paths of its sample go on, each by points of its own. hits: by lane; NULL
// where every lane has its surface already.
static void share_first_hits(struct wave *w, uint32_t paths, struct accel_hit *hits) {
    const uint32_t begun = w->count;
    for (uint32_t path = 1; path < paths; path++)
        for (uint32_t k = 0; k < begun; k++) {
            const uint32_t from = w->alive[k], to = from + path * samples_of_wave(paths);
            if (hits && hits[from].shape == SCENE_NONE)
                continue;
            if (hits)
                hits[to] = hits[from];
            w->lanes[to] = w->lanes[from];
            become_path(&w->lanes[to], path, paths);
            w->alive[w->count++] = (uint16_t)to;
        }
    for (uint32_t k = 0; paths > 1 && k < begun; k++)
        if (!hits || hits[w->alive[k]].shape != SCENE_NONE)
            become_path(&w->lanes[w->alive[k]], 0, paths);
}

// Drops the lanes that have ended at a vertex, after the shadow rays of all.
static void settle(struct trace_context *ctx, struct wave *w, bool first) {
    uint16_t pending[MOST_LANES];
    uint32_t survivors = 0, tests = 0;
    for (uint32_t k = 0; k < w->count; k++) {
        const uint16_t i = w->alive[k];
        pending[tests] = i; // no branches: nothing foretells them
        tests += w->lanes[i].shadow.pending;
        w->alive[survivors] = i; // never ahead of what is read
        survivors += w->lanes[i].alive;
    }
    w->count = survivors;
    if (tests)
        finish_shadows(ctx, w->lanes, pending, tests, first);
}

// One vertex of every living lane, stage by stage.
static void advance(const struct path *p, struct trace_context *ctx, struct wave *w, bool camera) {
    struct step step;
    struct packet packet;
    for (uint32_t first = 0; first < w->count; first += (uint32_t)packet.count) {
        packet = packet_at(ctx->world, w->alive, w->count, first, camera);
        find_hits(ctx, w->lanes, &packet, camera, step.hits);
    }
    if (camera)
        share_first_hits(w, paths_of_sample(p, ctx), step.hits);
    path_sample_ahead(p, ctx, w->lanes, w->alive, w->count, &step);
    shade_all(p, ctx, w, &step);
    settle(ctx, w, camera);
}

// The first vertex, where it is no hit.
static void begin_at_surfaces(const struct path *p, struct trace_context *ctx, struct wave *w,
                              const struct path_start *starts) {
    share_first_hits(w, paths_of_sample(p, ctx), NULL);
    for (uint32_t k = 0; k < w->count; k++) {
        struct lane *l = &w->lanes[w->alive[k]];
        l->shadow.pending = false;
        path_shade_surface(p, ctx, l, starts[l->sample].surface, NULL);
    }
    settle(ctx, w, true);
}

// The samples [first, end) of a call.
static void trace_wave(const struct path *p, struct trace_context *ctx,
                       const struct path_start *starts, uint32_t first, uint32_t end) {
    struct wave w;
    for (w.count = 0; first + w.count < end; w.count++) {
        start(ctx, &w.lanes[w.count], &starts[first + w.count], first + w.count);
        w.alive[w.count] = (uint16_t)w.count;
    }
    if (starts->surface)
        begin_at_surfaces(p, ctx, &w, starts);
    for (bool camera = !starts->surface; w.count; camera = false)
        advance(p, ctx, &w, camera);
}

static void trace(const void *data, struct trace_context *ctx, const struct path_start *starts) {
    const struct path *p = data;
    const uint32_t most = samples_of_wave(paths_of_sample(p, ctx));
    for (uint32_t i = 0; path_may_contribute(p, 0) && i < ctx->lanes; i += most)
        trace_wave(p, ctx, starts, i, ctx->lanes - i < most ? ctx->lanes : i + most);
}

const struct integrator_type integrator_path = {
    .entry = {.name = "path",
              .help = "path tracing with next event estimation and MIS (Kajiya 1986; Veach 1995)",
              .params = params, .size = sizeof(struct path)},
    .prepare = prepare, .trace = trace, .most_lanes = MOST_LANES, .meters = true,
};
