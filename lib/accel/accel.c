// SPDX-License-Identifier: Apache-2.0
// Embree keeps one geometry per shape (its index is the geometry's) and one per instance (after
// the shapes). Quadrics are user geometries that are intersected in object space, in double.
#include "accel/accel.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#define EMBREE_4 1
#else
#include <embree3/rtcore.h>
#define EMBREE_4 0
#endif

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#if defined(__SSE__)
#include <immintrin.h>
#endif

#include "accel/few.h"
#include "accel/few_blockers.h"
#include "accel/few_packet.h"
#include "accel/placed_quadric.h"
#include "base/log.h"
#include "base/mem.h"

struct accel {
    RTCDevice device;
    RTCScene world;
    RTCScene *groups; // one per shapegroup
    uint32_t group_count, shape_count;
    bool has_instances;
    struct placed_quadric *quadrics; // by shape index; NULL: the scene has none
    struct few *few;                 // NULL: the scene is too large for it
    struct few *blockers;            // of such a scene, the first to try; NULL: none
    atomic_llong bytes;
};

const char *accel_version(void) {
    return "Embree " RTC_VERSION_STRING;
}

void accel_thread_init(void) {
#if defined(__SSE__)
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _mm_setcsr(_mm_getcsr() | 0x0040); // denormals are zero
#endif
}

size_t accel_bytes(const struct accel *a) {
    return (size_t)atomic_load(&a->bytes);
}

void *accel_embree_scene(const struct accel *a) {
    return a->world;
}

static void report_embree(void *user, enum RTCError code, const char *text) {
    (void)user;
    log_error("Embree: error %d: %s", (int)code, text);
}

static bool count_bytes(void *user, ssize_t bytes, bool post) {
    struct accel *a = user;
    (void)post;
    atomic_fetch_add(&a->bytes, bytes);
    return true;
}

// ---- quadrics ---------------------------------------------------------------------------------

static void quadric_world_bounds(const struct RTCBoundsFunctionArguments *args) {
    float lo[3], hi[3];
    placed_quadric_bounds(args->geometryUserPtr, lo, hi);
    *args->bounds_o = (struct RTCBounds){.lower_x = lo[0], .lower_y = lo[1], .lower_z = lo[2],
                                         .upper_x = hi[0], .upper_y = hi[1], .upper_z = hi[2]};
}

// Rays and hits of n lanes arrive as n values of each field in turn (Embree names these only in
// C++): the fields, in order.
enum ray_field { ORG_X, ORG_Y, ORG_Z, TNEAR, DIR_X, DIR_Y, DIR_Z, TIME, TFAR };
enum hit_field { NG_X, NG_Y, NG_Z, HIT_U, HIT_V, PRIM_ID, GEOM_ID, INST_ID };

struct lanes {
    float *ray;
    unsigned n;
};

static double lane(const struct lanes *l, enum ray_field field, unsigned i) {
    return (double)l->ray[(unsigned)field * l->n + i];
}

static bool quadric_hit(const struct placed_quadric *q, const struct lanes *l, unsigned i,
                        double *t) {
    const double o[3] = {lane(l, ORG_X, i), lane(l, ORG_Y, i), lane(l, ORG_Z, i)};
    const double d[3] = {lane(l, DIR_X, i), lane(l, DIR_Y, i), lane(l, DIR_Z, i)};
    return placed_quadric_hit(q, o, d, lane(l, TNEAR, i), lane(l, TFAR, i), t);
}

static void quadric_intersect_n(const struct RTCIntersectFunctionNArguments *args) {
    const unsigned n = args->N;
    const struct lanes rays = {(float *)args->rayhit, n};
    unsigned *hit = (unsigned *)args->rayhit + 12 * n; // after the 12 fields of the rays
    for (unsigned i = 0; i < n; i++) {
        double t;
        if (!args->valid[i] || !quadric_hit(args->geometryUserPtr, &rays, i, &t))
            continue;
        rays.ray[TFAR * n + i] = (float)t;
        hit[HIT_U * n + i] = hit[HIT_V * n + i] = 0;
        hit[PRIM_ID * n + i] = args->primID;
        hit[GEOM_ID * n + i] = args->geomID;
        hit[INST_ID * n + i] = args->context->instID[0];
    }
}

static void quadric_occluded_n(const struct RTCOccludedFunctionNArguments *args) {
    const struct lanes rays = {(float *)args->ray, args->N};
    for (unsigned i = 0; i < args->N; i++) {
        double t;
        if (args->valid[i] && quadric_hit(args->geometryUserPtr, &rays, i, &t))
            rays.ray[TFAR * args->N + i] = -INFINITY;
    }
}

// ---- building ---------------------------------------------------------------------------------

static RTCGeometry quadric_geometry(struct accel *a, struct placed_quadric *q) {
    RTCGeometry g = rtcNewGeometry(a->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, 1);
    rtcSetGeometryUserData(g, q);
    rtcSetGeometryBoundsFunction(g, quadric_world_bounds, NULL);
    rtcSetGeometryIntersectFunction(g, quadric_intersect_n);
    rtcSetGeometryOccludedFunction(g, quadric_occluded_n);
    return g;
}

static RTCGeometry mesh_geometry(struct accel *a, const struct mesh *m) {
    RTCGeometry g = rtcNewGeometry(a->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, m->positions, 0,
                               sizeof *m->positions, m->vertex_count);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, m->indices, 0,
                               sizeof *m->indices, m->triangle_count);
    return g;
}

static RTCScene new_scene(struct accel *a, bool may_leak) {
    RTCScene s = rtcNewScene(a->device);
    rtcSetSceneFlags(s, may_leak ? RTC_SCENE_FLAG_NONE : RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(s, RTC_BUILD_QUALITY_HIGH);
    return s;
}

static void attach(RTCScene s, RTCGeometry g, uint32_t id) {
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(s, g, id);
    rtcReleaseGeometry(g);
}

static bool attach_shape(struct accel *a, const struct scene *scene, uint32_t i) {
    const struct shape *shape = &scene->shapes[i];
    RTCScene target = shape->group == SCENE_NONE ? a->world : a->groups[shape->group];
    if (shape->kind == SHAPE_MESH) {
        if (shape->mesh.triangle_count)
            attach(target, mesh_geometry(a, &shape->mesh), i);
        return true;
    }
    if (!a->quadrics)
        a->quadrics = mem_array(scene->shape_count, sizeof *a->quadrics);
    struct placed_quadric *q = &a->quadrics[i];
    if (!placed_quadric_init(q, scene, i)) {
        log_error_at(shape->at, "shape %s has a singular to_world transform", shape->type);
        return false;
    }
    attach(target, quadric_geometry(a, q), i);
    return true;
}

static void attach_instance(struct accel *a, const struct scene *scene, uint32_t i) {
    const struct instance *instance = &scene->instances[i];
    RTCGeometry g = rtcNewGeometry(a->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(g, a->groups[instance->group]);
    float columns[12];
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++)
            columns[3 * c + r] = (float)instance->to_world.m[r][c];
    rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    attach(a->world, g, scene->shape_count + i);
}

struct accel *accel_create(const struct scene *scene, int threads) {
    struct accel *a = mem_array(1, sizeof *a);
    char config[64];
    snprintf(config, sizeof config, "threads=%d", threads > 0 ? threads : 0);
    a->device = rtcNewDevice(config);
    if (!a->device) {
        log_error("Embree: no device: error %d", (int)rtcGetDeviceError(NULL));
        goto fail;
    }
    rtcSetDeviceErrorFunction(a->device, report_embree, NULL);
    rtcSetDeviceMemoryMonitorFunction(a->device, count_bytes, a);
    a->shape_count = scene->shape_count;
    a->has_instances = scene->instance_count > 0;
    a->world = new_scene(a, scene->may_leak);
    a->groups = mem_array(scene->group_count, sizeof *a->groups);
    for (; a->group_count < scene->group_count; a->group_count++)
        a->groups[a->group_count] = new_scene(a, scene->may_leak);
    for (uint32_t i = 0; i < scene->shape_count; i++)
        if (!attach_shape(a, scene, i))
            goto fail;
    for (uint32_t i = 0; i < scene->group_count; i++)
        rtcCommitScene(a->groups[i]);
    for (uint32_t i = 0; i < scene->instance_count; i++)
        attach_instance(a, scene, i);
    rtcCommitScene(a->world);
    if (rtcGetDeviceError(a->device) != RTC_ERROR_NONE)
        goto fail;
    a->few = few_create(scene);
    return a;
fail:
    accel_destroy(a);
    return NULL;
}

void accel_destroy(struct accel *a) {
    if (!a)
        return;
    for (uint32_t i = 0; i < a->group_count; i++)
        rtcReleaseScene(a->groups[i]);
    if (a->world)
        rtcReleaseScene(a->world);
    if (a->device)
        rtcReleaseDevice(a->device);
    few_destroy(a->few);
    few_destroy(a->blockers);
    mem_free(a->groups);
    mem_free(a->quadrics);
    mem_free(a);
}

void accel_learn_blockers(struct accel *a, const struct scene *scene, const struct ray *rays,
                          uint32_t count) {
    struct few_facet facets[FEW_BLOCKERS];
    few_destroy(a->blockers);
    a->blockers = few_create_of(facets, few_blockers_of(a, scene, rays, count, facets));
}

// ---- queries ----------------------------------------------------------------------------------

static struct RTCRay to_embree(const struct ray *r) {
    return (struct RTCRay){.org_x = r->o[0], .org_y = r->o[1], .org_z = r->o[2],
                           .dir_x = r->d[0], .dir_y = r->d[1], .dir_z = r->d[2],
                           .tnear = r->tmin, .tfar = r->tmax, .mask = ~0u};
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
        const wide_mask traced = wide_mask_of(active >> i);
        struct accel_rays r;
        few_packet_rays(rays + i, active >> i, &r);
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
        if (!valid[i])
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
