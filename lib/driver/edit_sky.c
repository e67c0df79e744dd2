// SPDX-License-Identifier: Apache-2.0
#include "driver/edit_sky.h"

static spectrum radiance(const void *world, vec3 w) {
    return spectrum_clamp(world_environment(world, w), 0, 1e30f);
}

void edit_sky_init(struct light_triangles *t, const struct world *w, uint32_t first, uint32_t end,
                   int threads) {
    struct sky sky = {radiance, w, 0};
    struct light_triangles coarse;
    *t = (struct light_triangles){.count = 0};
    for (uint32_t i = 0; i < w->infinite_count; i++) {
        const struct world_light *l = &w->lights[w->infinite[i]];
        const double detail = l->type->detail ? (double)l->type->detail(l->data) : 0;
        if (detail > 0 && (sky.detail == 0 || detail < sky.detail))
            sky.detail = detail;
    }
    if (w->infinite_count == 0)
        return;
    light_triangles_init(t, &sky, end, threads);
    if (first == 0)
        return;
    light_triangles_init(&coarse, &sky, first, threads);
    light_triangles_refine(t, &coarse);
    light_triangles_finish(&coarse);
}
