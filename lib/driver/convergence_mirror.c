// SPDX-License-Identifier: Apache-2.0
// The light that mirrors throw on surfaces.
//
// A path from a point to a mirror ends in a small light almost never, which is just what is to be
// found out. So it need only come near: light whose direction is within CONE of that of the path
// counts, divided by the solid angle of the cone (path space regularisation: Kaplanyan and
// Dachsbacher 2013). Caustics are blurred by that; what they bring to all points together stays.
#include "driver/convergence_probe.h"
#include "math/hash.h"
#include "math/warp.h"

enum { DIRECTIONS = 128 };

static const float COS_CONE = 0.9659258f; // 15 degrees

struct mirror_path {
    struct ray ray;
    double weight;
    bool mirrored;
};

static struct vec2 draw(struct rng *rng) {
    const float x = rng_float(rng);
    return (struct vec2){x, rng_float(rng)};
}

// Light of one of the lights at a surface that sends it along wi.
static void add_light(const struct probe *b, const struct surface *s, vec3 wi, double weight,
                      struct rng *rng, struct tally *tallies) {
    const double cone = 2 * (double)PI * (1 - (double)COS_CONE);
    const uint32_t k = (uint32_t)((uint64_t)rng_u32(rng) * b->lights >> 32);
    const uint32_t light = probe_light(b, k);
    struct light_sample l;
    double energy;
    int glass;
    if (!probe_sample_light(b, s->p, light, draw(rng), &l, &energy) || dot(l.wi, wi) < COS_CONE ||
        dot(l.wi, s->ng) * dot(wi, s->ng) <= 0 ||
        !probe_reaches(b->world, world_ray_to_light(surface_offset(s, l.wi), &l), light, &glass) ||
        glass > 0)
        return;
    energy *= weight * (double)PI * b->lights / cone * CONVERGENCE_LIGHT_SAMPLES / DIRECTIONS;
    if (!probe_add_hard(&tallies[k].mirrored, &l, 1, energy))
        tallies[k].easy += energy;
}

// On to the next surface and off it; false: the path ends.
static bool step(const struct probe *b, struct mirror_path *path, struct rng *rng,
                 struct tally *tallies) {
    struct accel_hit hit;
    struct surface s;
    struct bsdf_sample sample;
    struct closure_stack stack = {.used = 0};
    if (!accel_intersect(b->world->accel, &path->ray, &hit))
        return false;
    world_surface(b->world, &path->ray, &hit, &s);
    if (bsdf_lobes(s.bsdf) & LOBE_SMOOTH)
        return false;
    const struct closure *c =
        bsdf_resolve(s.bsdf, &s.point, to_local(&s.point.frame, -path->ray.d), &stack);
    const float lobe = rng_float(rng);
    if (!c || !closure_sample(c, lobe, draw(rng), &sample))
        return false;
    const vec3 wi = sample.lobe & LOBE_NULL ? path->ray.d : to_world(&s.point.frame, sample.wi);
    path->weight *= (double)spectrum_luminance(sample.weight);
    path->mirrored |= (sample.lobe & LOBE_REFLECTION) != 0;
    if (path->mirrored)
        add_light(b, &s, wi, path->weight, rng, tallies);
    path->ray = (struct ray){surface_offset(&s, wi), wi, 0, INFINITY};
    return true;
}

void probe_mirrors(const struct probe *b, struct tally *tallies) {
    struct rng rng = {1};
    if (b->lights == 0)
        return;
    for (uint32_t i = 0; i < b->count * DIRECTIONS; i++) {
        const struct probe_point *from = &b->points[i / DIRECTIONS];
        const struct frame frame = frame_from_normal(from->n);
        const vec3 d = to_world(&frame, warp_cosine_hemisphere(draw(&rng)));
        const vec3 o = offset_point(from->p, from->p_error, from->n, d);
        struct mirror_path path = {{o, d, 0, INFINITY}, 1, false};
        for (int k = 0; k < CONVERGENCE_MOST_EVENTS && step(b, &path, &rng, tallies); k++)
            ;
    }
}
