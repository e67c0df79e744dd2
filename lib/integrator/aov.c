// SPDX-License-Identifier: Apache-2.0
// Layers of what is seen first, with or without the picture of a nested integrator.
#include "integrator/path.h"

#include <string.h>

#include "base/log.h"
#include "integrator/camera_packet.h"
#include "sink/film.h"

struct aov {
    const char *aovs;
    const struct object *nested;
};

static const struct param params[] = {
    {"aovs", PARAM_STRING, offsetof(struct aov, aovs), .def = "albedo:albedo,nn:sh_normal,dd:depth",
     .unit = "", .help = "layers as name:type,... with types albedo, depth, position, uv, "
                         "geo_normal, sh_normal, shape_index"},
    {"integrator", PARAM_INTEGRATOR, offsetof(struct aov, nested), .unit = "", .optional = true,
     .help = "makes the picture; without one it stays black"},
    INTEGRATOR_IGNORED,
    PARAM_END,
};

static const struct {
    const char *name;
    uint32_t bit;
} types[] = {{"albedo", AOV_ALBEDO},      {"depth", AOV_Z},    {"position", AOV_P},
             {"uv", AOV_UV},              {"geo_normal", AOV_NG}, {"sh_normal", AOV_N},
             {"shape_index", AOV_SHAPE}};

static bool parse_layer(struct where at, const char *type, size_t n, uint32_t *aovs) {
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strlen(types[i].name) == n && strncmp(types[i].name, type, n) == 0) {
            *aovs |= types[i].bit;
            return true;
        }
    log_error_at(at, "aovs: '%.*s' is not a layer; known are albedo, depth, position, uv, "
                     "geo_normal, sh_normal, shape_index", (int)n, type);
    return false;
}

static bool prepare(struct object *self, struct integrator_wants *wants) {
    const struct aov *a = self->data;
    for (const char *s = a->aovs; *s;) {
        s += strspn(s, " ,");
        const size_t n = strcspn(s, ",");
        const char *colon = memchr(s, ':', n);
        const char *type = colon ? colon + 1 : s;
        if (n && !parse_layer(self->at, type, (size_t)(s + n - type), &wants->aovs))
            return false;
        s += n;
    }
    const struct integrator_type *nested = a->nested ? integrator_type_of(a->nested) : NULL;
    return !nested || !nested->prepare || nested->prepare((struct object *)a->nested, wants);
}

// Goes straight through what lets the ray pass, by the decisions that path makes. false: nothing is
// there.
static bool find_solid(struct trace_context *ctx, int lane, const struct path_start *start,
                       struct ray *ray, struct accel_hit *hit, struct surface *s) {
    struct sampler sampler = start->sampler;
    float passed = 0;
    for (uint32_t events = 0; hit->shape != SCENE_NONE; events++) {
        struct bsdf_sample b;
        world_surface(ctx->world, ray, hit, s);
        s->t += passed;
        if (!ctx->world->shadow_rays_may_pass || events >= INTEGRATOR_MOST_EVENTS)
            return true;
        const vec3 wo = to_local(&s->point.frame, -ray->d);
        const struct closure *closure = response_resolve(ctx, lane, 0, s, wo);
        const uint32_t first = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * events;
        sampler.dimension = first + DRAW_LOBE;
        const float lobe = sampler_1d(&sampler);
        sampler.dimension = first + DRAW_DIRECTION;
        if (!closure || !(closure->lobes & LOBE_NULL) ||
            !closure_sample(closure, lobe, sampler_2d(&sampler), &b) || !(b.lobe & LOBE_NULL))
            return true;
        passed = s->t;
        *ray = (struct ray){surface_offset(s, ray->d), ray->d, 0, INFINITY};
        ctx->rays++;
        accel_intersect(ctx->world->accel, ray, hit);
        if (ctx->world->hides)
            world_see(ctx->world, ray, hit);
    }
    return false;
}

static void trace_first_hits(struct trace_context *ctx, const struct path_start starts[SINK_LANES]) {
    struct ray rays[SINK_LANES];
    struct accel_hit hits[SINK_LANES];
    camera_packet_trace(ctx, starts, rays, hits);
    for (int i = 0; i < SINK_LANES; i++) {
        struct surface s;
        if (!find_solid(ctx, i, &starts[i], &rays[i], &hits[i], &s))
            continue;
        ctx->sink->type->covered(ctx->sink, i);
        if (!ctx->sink->wants_surface)
            continue;
        const vec3 wo = to_local(&s.point.frame, -rays[i].d);
        vertex_add_first(ctx, i, &s, response_resolve(ctx, i, 0, &s, wo));
    }
}

static void trace(const void *data, struct trace_context *ctx,
                  const struct path_start starts[SINK_LANES]) {
    const struct aov *a = data;
    if (a->nested)
        integrator_type_of(a->nested)->trace(a->nested->data, ctx, starts);
    else
        trace_first_hits(ctx, starts);
}

static struct aov nothing_else = {"", NULL};

const struct object integrator_first_hits = {.type = &integrator_aov.entry, .data = &nothing_else};

const struct integrator_type integrator_aov = {
    .entry = {.name = "aov", .help = "layers of the first hit: albedo, normals, depth, ...",
              .params = params, .size = sizeof(struct aov)},
    .prepare = prepare, .trace = trace, .meters = true,
};
