// SPDX-License-Identifier: Apache-2.0
#include "accel/few_packet.h"

#include <string.h>

void few_packet_rays(const struct ray rays[WIDE_LANES], uint32_t active, struct accel_rays *p) {
    const size_t fields[3] = {offsetof(struct ray, o), offsetof(struct ray, d),
                              offsetof(struct ray, tmin)};
    wide f[3][4];
    for (int k = 0; k < 3; k++) {
        const float *row[WIDE_LANES];
        for (int i = 0; i < WIDE_LANES; i++)
            row[i] = (const float *)(const void *)((const char *)&rays[i] + fields[k]);
        wide_gather4(row, f[k]);
    }
    const wide_mask traced = wide_mask_of(active);
    *p = (struct accel_rays){{f[0][0], f[0][1], f[0][2]}, {f[1][0], f[1][1], f[1][2]}, f[2][0],
                             wide_select(traced, f[2][1], wide_of(-INFINITY))};
}

void few_packet_intersect(const struct few *f, const struct ray rays[ACCEL_PACKET],
                          uint32_t active, struct accel_hit hits[ACCEL_PACKET]) {
    for (; active; active >>= WIDE_LANES, rays += WIDE_LANES, hits += WIDE_LANES) {
        struct accel_rays r;
        struct accel_hits h;
        if (!(active & WIDE_ALL))
            continue;
        few_packet_rays(rays, active, &r);
        few_intersect(f, &r, &h);
        for (int i = 0; i < WIDE_LANES; i++)
            if (active >> i & 1)
                hits[i] = (struct accel_hit){h.t[i], h.u[i], h.v[i], h.shape[i], h.primitive[i],
                                             SCENE_NONE};
    }
}

uint32_t few_packet_occluded(const struct few *f, const struct ray rays[ACCEL_PACKET],
                             uint32_t active) {
    uint32_t blocked = 0;
    for (int i = 0; i < ACCEL_PACKET; i += WIDE_LANES) {
        struct accel_rays r;
        if (!(active >> i & WIDE_ALL))
            continue;
        few_packet_rays(rays + i, active >> i, &r);
        blocked |= few_occluded(f, &r) << i;
    }
    return blocked;
}

uint32_t few_packet_blocked(const struct few *f, const struct ray *rays, uint32_t count) {
    const uint32_t active = (1u << count) - 1;
    struct ray whole[ACCEL_PACKET] = {0};
    if (count < ACCEL_PACKET)
        rays = memcpy(whole, rays, count * sizeof *rays);
    return few_packet_occluded(f, rays, active) & active;
}
