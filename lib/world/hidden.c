// SPDX-License-Identifier: Apache-2.0
// Shapes that the sensor does not see. Its rays go on behind them; none other does.
#include "world/world.h"

static bool is_hidden(const struct world *w, const struct accel_hit *hit) {
    if (hit->shape == SCENE_NONE)
        return false;
    return w->shapes[hit->shape].hidden ||
           (hit->instance != SCENE_NONE && w->scene->instances[hit->instance].hidden);
}

void world_see(const struct world *w, const struct ray *ray, struct accel_hit *hit) {
    struct ray r = *ray;
    while (is_hidden(w, hit)) {
        // The same surface may be found again, by rounding, and is passed again.
        r.tmin = hit->t + maxf(hit->t * 0x1p-20f, 1e-30f);
        if (!accel_intersect(w->accel, &r, hit))
            hit->shape = SCENE_NONE;
    }
}
