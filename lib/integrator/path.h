// SPDX-License-Identifier: Apache-2.0
// What the path tracer keeps of its paths, and the shading of many at once.
#pragma once

#include "integrator/candidates.h"
#include "integrator/vertex.h"
#include "world/light_lanes.h"

struct path {
    int max_depth, rr_depth, shading_samples;
    bool hide_emitters, strict_normals;
    int light_choice, light_candidates;
};

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
    DRAW_CANDIDATE = 7,
};

enum {
    LEAST_IN_PACKET = 4, // rays: fewer are faster one by one
    MOST_LANES = SINK_MOST_LANES,
    MOST_SHADING_SAMPLES = MOST_LANES / SINK_LANES,
};

struct lane {
    struct ray ray;
    spectrum beta;
    struct path_origin from;
    struct sampler sampler;
    float scale; // beta times this is what roulette goes by: blind to the radiance scaling of
                 // refraction (squared relative indices) and to how many share the first hit
    uint32_t events; // vertices, null ones included
    uint16_t sample; // the sink's lane
    bool alive, first_done;
    struct shadow_test shadow;
};

// Some lanes of a wave, SINK_LANES at most, by index.
struct packet {
    const uint16_t *lanes;
    int count;
};

static inline bool path_may_contribute(const struct path *p, uint32_t edges) {
    return p->max_depth < 0 || edges < (uint32_t)p->max_depth;
}

// Kinds of material by which path_shade_wide can shade: none, the world's, and the response's own.
enum { KIND_ALONE = 0, KIND_OWN = WORLD_MOST_WIDE_KINDS, PATH_KINDS };

static inline uint32_t path_wide_kind(const struct trace_context *ctx, const struct lane *l,
                                      const struct accel_hit *hit) {
    const struct response *r = ctx->response;
    const uint32_t kind = ctx->world->shapes[hit->shape].wide_kind;
    if (!kind || (!l->first_done && ctx->sink->wants_surface))
        return KIND_ALONE;
    if (r == &response_physical)
        return kind;
    const enum response_way way =
        r->way ? r->way(r, ctx, l->sample, l->from.depth, hit->shape) : RESPONSE_ALONE;
    return way == RESPONSE_WORLD ? kind : way == RESPONSE_OWN ? KIND_OWN : KIND_ALONE;
}

// What random numbers depend on, and what lies beside it.
struct lane_state {
    struct sampler_lanes sampler;
    wide scale;
    wide_uint events;
};

// Four numbers of each lane, at an offset in struct lane.
static inline void path_gather(struct lane *const lane[WIDE_LANES], size_t offset, wide f[4]) {
    const float *row[WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = (const float *)(const void *)((const char *)lane[i] + offset);
    wide_gather4(row, f);
}

void path_gather_state(struct lane *const lane[WIDE_LANES], struct lane_state *out);
void path_draw(struct lane *const lane[WIDE_LANES], const struct lane_state *s, uint32_t purpose,
               wide u[2]);

// The sample of a far light, taken before its place was known.
struct light_ahead {
    float wi[3], pdf_sa; // 0: it does not light; below: not taken
    spectrum emission;
};

// What is known of the lanes of a wave before they are shaded; by lane.
struct step {
    struct accel_hit hits[MOST_LANES];
    bool ahead; // whether light samples do not depend on the place, and are taken first
    struct light_ahead lights[MOST_LANES];
    struct light_ahead more[MOST_LANES][MOST_CANDIDATES - 1]; // where the material may be glossy
};

// The samples that were taken ahead for a lane.
struct lights_ahead {
    const struct light_ahead *first, *more;
};

static inline struct lights_ahead path_lights_of(const struct step *s, uint32_t lane) {
    return (struct lights_ahead){&s->lights[lane], s->more[lane]};
}

static inline const struct light_ahead *path_candidate(struct lights_ahead l, uint32_t k) {
    return k ? &l.more[k - 1] : l.first;
}

// How many light samples a vertex with these lobes chooses from.
static inline uint32_t path_candidates(const struct path *p, const struct trace_context *ctx,
                                       uint32_t lobes) {
    if (!(lobes & LOBE_GLOSSY) || !ctx->sink->sums)
        return 1;
    if (p->light_candidates > 0)
        return (uint32_t)p->light_candidates;
    return world_has_only_a_sky(ctx->world) ? CANDIDATES_OF_A_SKY : 1;
}

// Whether candidates may be of different lights: what a late one emits is then asked for at once, since
// its density tells how its directions compare, and not lights.
static inline bool path_compares_lights(const struct world *w, uint32_t candidates) {
    return candidates > 1 && w->light_count > 1;
}

// Takes the light samples of the lanes listed: those of world_sample_lights.
void path_sample_ahead(const struct path *p, const struct trace_context *ctx, struct lane *lanes,
                       const uint16_t *list, uint32_t count, struct step *step);
struct light_sample path_light_ahead(const struct world *w, const struct light_ahead *l);
uint32_t path_lights_ahead(const struct world *w, const struct light_ahead *const l[WIDE_LANES],
                           uint32_t wanted, struct light_lanes *out);

void path_leave_scene(const struct path *p, struct trace_context *ctx, struct lane *l);
// One vertex: emission found, light sampled, direction chosen. ahead: the light samples, NULL where
// they are not known.
void path_shade_surface(const struct path *p, struct trace_context *ctx, struct lane *l,
                        const struct surface *s, const struct lights_ahead *ahead);
// One vertex of a packet's lanes, WIDE_LANES at most, whose materials are of this kind: the same as
// one by one, with the same bits.
void path_shade_wide(const struct path *p, struct trace_context *ctx, struct lane *lanes,
                     const struct packet *packet, const struct step *step, uint32_t kind);
