// SPDX-License-Identifier: Apache-2.0
// Random numbers of many paths at once.
#include "integrator/path.h"

void path_gather_state(struct lane *const lane[WIDE_LANES], struct lane_state *out) {
    wide f[4];
    path_gather(lane, offsetof(struct lane, sampler.seed), f); // seed, index, count, dimension
    out->sampler.seed = (wide_uint)f[0];
    out->sampler.index = (wide_uint)f[1];
    path_gather(lane, offsetof(struct lane, sampler.reversed), f); // reversed, padding, scale, events
    out->sampler.reversed = (wide_uint)f[0];
    out->scale = f[2];
    out->events = (wide_uint)f[3];
}

void path_draw(struct lane *const lane[WIDE_LANES], const struct lane_state *state, uint32_t purpose,
               wide u[2]) {
    const bool pair = purpose == DRAW_LIGHT_POINT || purpose == DRAW_DIRECTION;
    const wide_uint dimension = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * state->events + purpose;
    const struct sampler_type *type = lane[0]->sampler.type;
    if (type->draw_wide) {
        type->draw_wide(&state->sampler, dimension, u);
        return;
    }
    for (int i = 0; i < WIDE_LANES; i++) {
        struct sampler s = lane[i]->sampler;
        s.dimension = dimension[i];
        const struct vec2 one = pair ? sampler_2d(&s) : (struct vec2){sampler_1d(&s), 0};
        u[0][i] = one.x;
        u[1][i] = one.y;
    }
}
