// SPDX-License-Identifier: Apache-2.0
// What is seen first, and no more of it than a survey needs to know.
#include "integrator/camera_packet.h"
#include "integrator/symbolic.h"

// Whether the shape alone tells the object.
static bool is_plain(const struct symbolic *s, uint32_t shape) {
    const int object = s->object_of_shape[shape];
    return object == CHAIN_FIXED || (s->two_sided[shape] && !s->objects[object].knows_view);
}

static void see(const struct symbolic *s, struct trace_context *ctx, int lane,
                const struct ray *ray, const struct accel_hit *hit) {
    struct surface surface;
    ctx->sink->type->covered(ctx->sink, lane);
    if (is_plain(s, hit->shape)) {
        ctx->sink->chains[lane].object = s->object_of_shape[hit->shape];
        return;
    }
    world_surface(ctx->world, ray, hit, &surface);
    response_resolve(ctx, lane, 0, &surface, to_local(&surface.point.frame, -ray->d));
}

static void trace(const void *data, struct trace_context *ctx, const struct path_start *starts) {
    struct ray rays[SINK_LANES];
    struct accel_hit hits[SINK_LANES];
    camera_packet_trace(ctx, starts, rays, hits);
    for (int i = 0; i < SINK_LANES; i++)
        if (hits[i].shape != SCENE_NONE)
            see(data, ctx, i, &rays[i], &hits[i]);
}

const struct integrator_type integrator_survey = {.entry = {.name = "survey"}, .trace = trace};
