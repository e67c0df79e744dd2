// SPDX-License-Identifier: Apache-2.0
// Embree keeps one geometry per shape (its index is the geometry's) and one per instance (after
// the shapes). Quadrics are user geometries that are intersected in object space, in double.
#include "accel/world.h"

#include <stdio.h>

#if defined(__SSE__)
#include <immintrin.h>
#endif

#include "accel/few_blockers.h"
#include "base/log.h"
#include "base/mem.h"

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
