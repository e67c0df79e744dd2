// SPDX-License-Identifier: Apache-2.0
// Shadow rays like those of a render, of paths that go on evenly from where they arrive. Which
// facets are tried first because of them changes no picture: a facet blocks what it blocks.
#include "base/mem.h"
#include "math/frame.h"
#include "math/hash.h"
#include "math/warp.h"
#include "world/world.h"

enum { PATHS = 256, VERTICES = 4 };

struct probes {
    struct ray rays[PATHS * VERTICES];
    uint32_t count;
};

static struct vec2 draw(struct rng *rng) {
    const float x = rng_float(rng);
    return (struct vec2){x, rng_float(rng)};
}

// The shadow ray of a point that is seen from a side of n.
static void add_probe(const struct world *w, const struct surface *s, vec3 n, struct rng *rng,
                      struct probes *p) {
    const struct light_place place = {s->p, n};
    const float u = rng_float(rng);
    struct light_sample l;
    uint32_t light;
    if (world_sample_light(w, &place, u, draw(rng), &light, &l) && dot(l.wi, n) > 0)
        p->rays[p->count++] = world_shadow_ray(s, &l);
}

static void follow(const struct world *w, struct ray ray, struct rng *rng, struct probes *p) {
    struct accel_hit hit;
    for (int k = 0; k < VERTICES && accel_intersect(w->accel, &ray, &hit); k++) {
        struct surface s;
        world_surface(w, &ray, &hit, &s);
        const vec3 n = dot(s.ng, ray.d) > 0 ? -s.ng : s.ng;
        const struct frame frame = frame_from_normal(n);
        add_probe(w, &s, n, rng, p);
        const vec3 d = to_world(&frame, warp_cosine_hemisphere(draw(rng)));
        ray = (struct ray){surface_offset(&s, d), d, 0, INFINITY};
    }
}

void world_learn_blockers(struct world *w, void (*start)(const void *, struct vec2, struct ray *),
                          const void *context) {
    struct rng rng = {0};
    if (accel_mixes_packets(w->accel) || w->shadow_rays_may_pass || !w->light_count)
        return;
    struct probes *p = mem_array(1, sizeof *p);
    for (int k = 0; k < PATHS; k++) {
        struct ray ray;
        start(context, draw(&rng), &ray);
        follow(w, ray, &rng, p);
    }
    accel_learn_blockers(w->accel, w->scene, p->rays, p->count);
    mem_free(p);
}
