// SPDX-License-Identifier: Apache-2.0
// Rays through the built scene: one by one, in packets, as streams.
#include "accel/few_packet.h"
#include "accel/world.h"

#include <string.h>

// Beyond this Embree's numbers overflow, and its checked builds end the program; so they do for what
// is no number at all. Such rays, of cameras beyond all scenes, meet nothing.
static const float FARTHEST = 1.8e18f;

static bool is_traceable(const struct ray *r) {
    const vec3 size = absolute(r->o) + absolute(r->d);
    return size[0] <= FARTHEST && size[1] <= FARTHEST && size[2] <= FARTHEST && r->tmin >= 0 &&
           r->tmax >= 0;
}

// Which of them are; the others are put where Embree does not stumble over them.
static wide_mask keep_traceable(struct accel_rays *r) {
    const wide farthest = wide_of(FARTHEST);
    const wide_mask x = wide_whole(wide_abs(r->o.x) + wide_abs(r->d.x) <= farthest);
    const wide_mask y = wide_whole(wide_abs(r->o.y) + wide_abs(r->d.y) <= farthest);
    const wide_mask z = wide_whole(wide_abs(r->o.z) + wide_abs(r->d.z) <= farthest);
    const wide_mask all = wide_both(wide_both(x, y), wide_both(z, r->tmin >= 0));
    wide *const numbers[] = {&r->o.x, &r->o.y, &r->o.z, &r->d.x, &r->d.y, &r->d.z, &r->tmin};
    for (int i = 0; i < 7 && wide_bits(all) != WIDE_ALL; i++)
        *numbers[i] = wide_select(all, *numbers[i], wide_of(0));
    return wide_both(all, r->tmax >= 0);
}

static struct RTCRay to_embree(const struct ray *r) {
    static const struct ray none = {.d = {0, 0, 1}, .tmin = 1};
    const struct ray *from = is_traceable(r) ? r : &none;
    return (struct RTCRay){.org_x = from->o[0], .org_y = from->o[1], .org_z = from->o[2],
                           .dir_x = from->d[0], .dir_y = from->d[1], .dir_z = from->d[2],
                           .tnear = from->tmin, .tfar = from->tmax, .mask = ~0u};
}

bool accel_intersect(const struct accel *a, const struct ray *ray, struct accel_hit *hit) {
    struct RTCRayHit rh;
    rh.ray = to_embree(ray);
    rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if EMBREE_4
    rtcIntersect1(a->world, &rh, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(a->world, &context, &rh);
#endif
    hit->t = rh.ray.tfar;
    hit->u = rh.hit.u;
    hit->v = rh.hit.v;
    hit->shape = rh.hit.geomID; // RTC_INVALID_GEOMETRY_ID == SCENE_NONE
    hit->primitive = rh.hit.primID;
    hit->instance =
        rh.hit.instID[0] == RTC_INVALID_GEOMETRY_ID ? SCENE_NONE : rh.hit.instID[0] - a->shape_count;
    return hit->shape != SCENE_NONE;
}

bool accel_occluded(const struct accel *a, const struct ray *ray) {
    struct RTCRay r = to_embree(ray);
#if EMBREE_4
    rtcOccluded1(a->world, &r, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(a->world, &context, &r);
#endif
    return r.tfar < 0;
}

static void packet_from(const struct ray rays[ACCEL_PACKET], uint32_t active, int valid[ACCEL_PACKET],
                        struct RTCRay16 *p) {
    for (int i = 0; i < ACCEL_PACKET; i += WIDE_LANES) {
        struct accel_rays r;
        few_packet_rays(rays + i, active >> i, &r);
        const wide_mask traced = wide_both(wide_mask_of(active >> i), keep_traceable(&r));
        memcpy(valid + i, &traced, sizeof traced);
        memcpy(p->org_x + i, &r.o.x, sizeof r.o.x);
        memcpy(p->org_y + i, &r.o.y, sizeof r.o.y);
        memcpy(p->org_z + i, &r.o.z, sizeof r.o.z);
        memcpy(p->dir_x + i, &r.d.x, sizeof r.d.x);
        memcpy(p->dir_y + i, &r.d.y, sizeof r.d.y);
        memcpy(p->dir_z + i, &r.d.z, sizeof r.d.z);
        memcpy(p->tnear + i, &r.tmin, sizeof r.tmin);
        memcpy(p->tfar + i, &r.tmax, sizeof r.tmax);
    }
    memset(p->time, 0, sizeof p->time);
    memset(p->mask, 0xff, sizeof p->mask);
    for (unsigned i = 0; i < ACCEL_PACKET; i++)
        p->id[i] = i;
    memset(p->flags, 0, sizeof p->flags);
}

bool accel_mixes_packets(const struct accel *a) {
    return a->few != NULL;
}

void accel_intersect16(const struct accel *a, const struct ray rays[ACCEL_PACKET], uint32_t active,
                       bool coherent, struct accel_hit hits[ACCEL_PACKET]) {
    if (a->few) {
        few_packet_intersect(a->few, rays, active, hits);
        return;
    }
    _Alignas(64) int valid[ACCEL_PACKET];
    struct RTCRayHit16 rh;
    packet_from(rays, active, valid, &rh.ray);
    for (int i = 0; i < ACCEL_PACKET; i++)
        rh.hit.geomID[i] = rh.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
#if EMBREE_4
    struct RTCIntersectArguments args;
    rtcInitIntersectArguments(&args);
    args.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect16(valid, a->world, &rh, &args);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                             : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid, a->world, &context, &rh);
#endif
    for (int i = 0; i < ACCEL_PACKET; i++) {
        if (!(active >> i & 1))
            continue;
        const unsigned instance = rh.hit.instID[0][i];
        hits[i] = (struct accel_hit){
            rh.ray.tfar[i], rh.hit.u[i], rh.hit.v[i], rh.hit.geomID[i], rh.hit.primID[i],
            instance == RTC_INVALID_GEOMETRY_ID ? SCENE_NONE : instance - a->shape_count};
    }
}

uint32_t accel_occluded16(const struct accel *a, const struct ray rays[ACCEL_PACKET],
                          uint32_t active, bool coherent) {
    if (a->few)
        return few_packet_occluded(a->few, rays, active);
    _Alignas(64) int valid[ACCEL_PACKET];
    struct RTCRay16 p;
    packet_from(rays, active, valid, &p);
    coherent = coherent && !a->has_instances; // Embree 3.13.5 may loop forever in an instance
#if EMBREE_4
    struct RTCOccludedArguments args;
    rtcInitOccludedArguments(&args);
    args.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcOccluded16(valid, a->world, &p, &args);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                             : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcOccluded16(valid, a->world, &context, &p);
#endif
    uint32_t blocked = 0;
    for (int i = 0; i < ACCEL_PACKET; i++)
        blocked |= (uint32_t)(valid[i] && p.tfar[i] < 0) << i;
    return blocked;
}

enum { STREAM = 256 };

// Embree 3 sorts the rays of a stream by octant and walks the tree for those of one together, each
// by itself.
static void trace_stream(const struct accel *a, struct RTCRay *rays, uint32_t count) {
#if EMBREE_4
    for (uint32_t i = 0; i < count; i++)
        rtcOccluded1(a->world, &rays[i], NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1M(a->world, &context, rays, count, sizeof *rays);
#endif
}

static void occluded_stream(const struct accel *a, const struct ray *rays, uint32_t count,
                            bool *blocked) {
    struct RTCRay left[STREAM];
    bool *result[STREAM];
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i += ACCEL_PACKET) {
        const uint32_t most = count - i < ACCEL_PACKET ? count - i : ACCEL_PACKET;
        const uint32_t bits = a->blockers ? few_packet_blocked(a->blockers, rays + i, most) : 0;
        for (uint32_t k = i; k < i + most; k++) {
            blocked[k] = bits >> (k - i) & 1;
            left[n] = to_embree(&rays[k]);
            result[n] = &blocked[k];
            n += !blocked[k];
        }
    }
    trace_stream(a, left, n);
    for (uint32_t k = 0; k < n; k++)
        *result[k] = left[k].tfar < 0;
}

void accel_occluded_each(const struct accel *a, const struct ray *rays, uint32_t count,
                         bool *blocked) {
    for (uint32_t i = 0; i < count; i += STREAM)
        occluded_stream(a, rays + i, count - i < STREAM ? count - i : STREAM, blocked + i);
}
