// SPDX-License-Identifier: Apache-2.0
// Packets into instances end, and see what single rays see, also where most lanes are idle or all
// rays are the same.
#include "accel/accel.h"
#include "check.h"
#include "math/hash.h"
#include "math/warp.h"
#include "scene_text.h"

static vec3 random_point(struct rng *r, float size) {
    return size * v3(2 * rng_float(r) - 1, 2 * rng_float(r) - 1, 2 * rng_float(r) - 1);
}

// From about one place towards about one other, as shadow rays of one tile run.
static void alike_rays(struct rng *rng, float spread, struct ray rays[ACCEL_PACKET]) {
    const vec3 from = random_point(rng, 4), to = random_point(rng, 1.5f);
    for (int i = 0; i < ACCEL_PACKET; i++) {
        const vec3 o = from + random_point(rng, spread);
        rays[i] = (struct ray){o, to + random_point(rng, spread) - o, 0, i % 3 ? 2 : INFINITY};
    }
}

// Rays through edges may differ.
static void packets_are_single_rays(const struct accel *a, bool coherent) {
    struct rng rng = {3};
    int found = 0, different = 0;
    for (int k = 0; k < 4000; k++) {
        struct ray rays[ACCEL_PACKET];
        struct accel_hit hits[ACCEL_PACKET], hit;
        const uint32_t active = k % 2 ? 1u << k % ACCEL_PACKET : rng_u32(&rng) & 0xffff;
        alike_rays(&rng, k % 4 < 2 ? 0 : 0.2f, rays);
        accel_intersect16(a, rays, active, coherent, hits);
        const uint32_t blocked = accel_occluded16(a, rays, active, coherent);
        for (int i = 0; i < ACCEL_PACKET; i++) {
            if (!(active >> i & 1))
                continue;
            const bool one = accel_intersect(a, &rays[i], &hit);
            found += one;
            different += (blocked >> i & 1) != one || (hits[i].shape != SCENE_NONE) != one ||
                         (one && (hits[i].instance != hit.instance || hits[i].shape != hit.shape ||
                                  fabsf(hits[i].t - hit.t) > 1e-4f * hit.t));
        }
    }
    printf("%s: %d hits, %d differ\n", coherent ? "coherent" : "any", found, different);
    CHECK(found > 5000 && different < 10);
}

int main(void) {
    scene_folder_open();
    struct scene *s = scene_parse(
        "<shape type='shapegroup' id='g'><shape type='sphere'/><shape type='cube'>"
        "<transform name='to_world'><scale value='0.4'/><translate x='1.5'/></transform></shape>"
        "</shape>\n"
        "<shape type='instance'><ref id='g'/></shape>\n"
        "<shape type='instance'><transform name='to_world'><scale x='0.3' y='1' z='2'/>"
        "<rotate x='1' y='1' angle='40'/><translate x='-1' y='0.5' z='1'/></transform>"
        "<ref id='g'/></shape>\n"
        "<shape type='rectangle'><transform name='to_world'><scale value='9'/>"
        "<translate z='-2'/></transform></shape>");
    struct accel *a = s ? accel_create(s, 1) : NULL;
    CHECK(a != NULL);
    if (!a)
        return check_result();
    accel_thread_init();
    packets_are_single_rays(a, false);
    packets_are_single_rays(a, true);
    accel_destroy(a);
    scene_destroy(s);
    scene_folder_close();
    return check_result();
}
