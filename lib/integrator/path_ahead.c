// SPDX-License-Identifier: Apache-2.0
// A large table of a sky makes a single sample wait for memory several times. Samples of a sky that
// is the only light need no place, so those of many lanes can wait together.
#include "integrator/path.h"
#include "world/light_lanes.h"

// Lanes that will need a sample, as far as is known before their materials are evaluated.
static uint32_t find_wanted(const struct path *p, const struct world *w, const struct lane *lanes,
                            const struct packet *packet, const struct accel_hit *hits) {
    uint32_t wanted = 0;
    for (int i = 0; i < packet->count; i++) {
        const uint16_t lane = packet->lanes[i];
        wanted |= (uint32_t)(w->shapes[hits[lane].shape].smooth &&
                             path_may_contribute(p, lanes[lane].events + 1)) << i;
    }
    return wanted;
}

static void draw(const struct lane *lanes, const struct packet *packet, wide u[2]) {
    float numbers[2][WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++) {
        const struct lane *l = &lanes[packet->lanes[i < packet->count ? i : 0]];
        struct sampler s = l->sampler;
        s.dimension = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * l->events + DRAW_LIGHT_POINT;
        const struct vec2 point = sampler_2d(&s);
        numbers[0][i] = point.x;
        numbers[1][i] = point.y;
    }
    u[0] = wide_load(numbers[0]);
    u[1] = wide_load(numbers[1]);
}

uint32_t path_sample_ahead(const struct path *p, const struct world *w, const struct lane *lanes,
                           const struct packet *packet, const struct accel_hit *hits,
                           struct light_ahead out[WIDE_LANES]) {
    const struct wide3 anywhere = {0};
    const wide no_choice = {0};
    struct light_lanes l;
    wide u[2];
    const uint32_t wanted = world_lights_are_far(w) ? find_wanted(p, w, lanes, packet, hits) : 0;
    if (__builtin_popcount(wanted) < LEAST_IN_PACKET)
        return 0;
    draw(lanes, packet, u);
    const uint32_t lit = world_sample_lights(w, wanted, &anywhere, &anywhere, no_choice, u, &l);
    for (uint32_t left = wanted; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        out[i].lit = lit >> i & 1;
        if (out[i].lit)
            out[i].s = light_lanes_at(&l, i);
    }
    return wanted;
}
