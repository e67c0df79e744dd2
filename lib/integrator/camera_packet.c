// SPDX-License-Identifier: Apache-2.0
#include "integrator/camera_packet.h"

void camera_packet_trace(struct trace_context *ctx, const struct path_start starts[SINK_LANES],
                         struct ray rays[SINK_LANES], struct accel_hit hits[SINK_LANES]) {
    for (int i = 0; i < SINK_LANES; i++)
        rays[i] = starts[i].ray;
    accel_intersect16(ctx->world->accel, rays, 0xffff, true, hits);
    ctx->rays += SINK_LANES;
    ctx->paths += SINK_LANES;
    for (int i = 0; ctx->world->hides && i < SINK_LANES; i++)
        world_see(ctx->world, &rays[i], &hits[i]);
}
