// SPDX-License-Identifier: Apache-2.0
// Which lights reach which visits.
#include "integrator/light_loop_data.h"

static bool is_above(const struct light_loop *l, const struct visit *v, uint32_t light) {
    return dot(v->pole, l->scene->centres[light]) > 0;
}

static struct ray ray_to(const struct light_loop *l, const struct visit *v, uint32_t light) {
    const vec3 wi = l->scene->centres[light];
    return (struct ray){surface_offset(&v->surface, wi), wi, 0, INFINITY};
}

static void arrive(struct light_loop *l, size_t visit, uint32_t light, spectrum through) {
    struct visit *v = &l->visits[visit];
    l->arrivals[visit * l->most + v->count++] =
        (struct arrival){light, {through[0], through[1], through[2]}};
}

// Visits [first, first + count) of one position, at most 16, towards each of its lights.
static uint64_t shadow_pixels(struct light_loop *l, size_t first, uint32_t count) {
    const struct light_loop_options *o = &l->scene->options;
    uint64_t traced = 0;
    const uint32_t position = l->visits[first].position;
    const uint32_t *end = light_loop_end(l->scene, position);
    for (const uint32_t *at = light_loop_first(l->scene, position); at < end; at++) {
        const uint32_t m = *at;
        struct ray rays[ACCEL_PACKET];
        uint32_t active = 0;
        for (uint32_t i = 0; i < count; i++)
            if (is_above(l, &l->visits[first + i], m)) {
                rays[i] = ray_to(l, &l->visits[first + i], m);
                active |= 1u << i;
            }
        if (!active)
            continue;
        traced += (uint64_t)__builtin_popcount(active);
        for (uint32_t left = active & ~accel_occluded16(o->world->accel, rays, active, true); left;
             left &= left - 1)
            arrive(l, first + (uint32_t)__builtin_ctz(left), m, spectrum_grey(1));
    }
    return traced;
}

static uint64_t shadow_lights(struct light_loop *l, size_t visit) {
    const struct light_loop_options *o = &l->scene->options;
    const struct visit *v = &l->visits[visit];
    uint32_t towards[ACCEL_PACKET], n = 0;
    struct ray rays[ACCEL_PACKET];
    uint64_t traced = 0;
    const uint32_t *last = light_loop_end(l->scene, v->position);
    for (const uint32_t *at = light_loop_first(l->scene, v->position); at < last || n > 0; at++) {
        const bool end = at >= last;
        if (!end && is_above(l, v, *at)) {
            towards[n] = *at;
            rays[n++] = ray_to(l, v, *at);
        }
        if (n < ACCEL_PACKET && !end)
            continue;
        const uint32_t active = (1u << n) - 1;
        traced += n;
        for (uint32_t left = active & ~accel_occluded16(o->world->accel, rays, active, true); left;
             left &= left - 1)
            arrive(l, visit, towards[__builtin_ctz(left)], spectrum_grey(1));
        n = 0;
    }
    return traced;
}

// Where surfaces may let light straight through.
static uint64_t shadow_through(struct light_loop *l, size_t visit) {
    const struct light_loop_options *o = &l->scene->options;
    const struct visit *v = &l->visits[visit];
    uint64_t traced = 0;
    const uint32_t *end = light_loop_end(l->scene, v->position);
    for (const uint32_t *at = light_loop_first(l->scene, v->position); at < end; at++) {
        const uint32_t m = *at;
        if (!is_above(l, v, m))
            continue;
        const spectrum through = world_transmittance(o->world, ray_to(l, v, m), -1,
                                                     v->surface.point.wavelengths);
        traced++;
        if (!spectrum_is_black(through))
            arrive(l, visit, m, through);
    }
    return traced;
}

static void arrive_everywhere(struct light_loop *l, size_t visit) {
    const struct visit *v = &l->visits[visit];
    const uint32_t *end = light_loop_end(l->scene, v->position);
    for (const uint32_t *at = light_loop_first(l->scene, v->position); at < end; at++)
        if (is_above(l, v, *at))
            arrive(l, visit, *at, spectrum_grey(1));
}

uint64_t light_loop_shadow(struct light_loop *l) {
    const struct light_loop_options *o = &l->scene->options;
    uint64_t traced = 0;
    mem_grow(&l->arrivals, &l->arrival_capacity, l->visit_count * l->most, sizeof *l->arrivals);
    for (size_t i = 0; i < l->visit_count; i++)
        l->visits[i].count = 0;
    for (size_t i = 0; i < l->visit_count;) {
        uint32_t n = 1;
        if (o->unshadowed) {
            arrive_everywhere(l, i);
        } else if (o->world->shadow_rays_may_pass) {
            traced += shadow_through(l, i);
        } else if (o->packets == PACKETS_OF_LIGHTS) {
            traced += shadow_lights(l, i);
        } else {
            while (n < ACCEL_PACKET && i + n < l->visit_count &&
                   l->visits[i + n].position == l->visits[i].position)
                n++;
            traced += shadow_pixels(l, i, n);
        }
        i += n;
    }
    return traced;
}
