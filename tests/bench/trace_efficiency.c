// SPDX-License-Identifier: Apache-2.0
// Trace efficiency: the time that bare single-ray Embree calls need for the very rays of a render,
// over the time of the render.
//
//     trace_efficiency SCENE [WxH] [SPP] [REPEATS]
//
// The linker wraps the ray queries (--wrap), so recording costs the product nothing. Renders and
// replays alternate on one thread; the medians are printed.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#define EMBREE_4 1
#else
#include <embree3/rtcore.h>
#define EMBREE_4 0
#endif

#include "base/mem.h"
#include "base/thread.h"
#include "driver/job.h"

struct record {
    struct ray ray;
    bool shadow;
};

static struct record *records;
static bool recording;
static size_t record_count, record_capacity;

static void record(const struct ray *ray, bool shadow) {
    mem_grow(&records, &record_capacity, record_count + 1, sizeof *records);
    records[record_count++] = (struct record){*ray, shadow};
}

bool __real_accel_intersect(const struct accel *, const struct ray *, struct accel_hit *);
bool __real_accel_occluded(const struct accel *, const struct ray *);
void __real_accel_intersect16(const struct accel *, const struct ray *, uint32_t, bool, struct accel_hit *);
uint32_t __real_accel_occluded16(const struct accel *, const struct ray *, uint32_t, bool);
bool __wrap_accel_intersect(const struct accel *, const struct ray *, struct accel_hit *);
bool __wrap_accel_occluded(const struct accel *, const struct ray *);
void __real_accel_occluded_each(const struct accel *, const struct ray *, uint32_t, bool *);
void __wrap_accel_occluded_each(const struct accel *, const struct ray *, uint32_t, bool *);
void __wrap_accel_intersect16(const struct accel *, const struct ray *, uint32_t, bool, struct accel_hit *);
uint32_t __wrap_accel_occluded16(const struct accel *, const struct ray *, uint32_t, bool);

bool __wrap_accel_intersect(const struct accel *a, const struct ray *r, struct accel_hit *h) {
    if (recording)
        record(r, false);
    return __real_accel_intersect(a, r, h);
}

bool __wrap_accel_occluded(const struct accel *a, const struct ray *r) {
    if (recording)
        record(r, true);
    return __real_accel_occluded(a, r);
}

static void record_packet(const struct ray *r, uint32_t active, bool shadow) {
    for (int i = 0; recording && i < 16; i++)
        if (active >> i & 1)
            record(&r[i], shadow);
}

void __wrap_accel_occluded_each(const struct accel *a, const struct ray *r, uint32_t count,
                                bool *blocked) {
    for (uint32_t i = 0; recording && i < count; i++)
        record(&r[i], true);
    __real_accel_occluded_each(a, r, count, blocked);
}

void __wrap_accel_intersect16(const struct accel *a, const struct ray *r, uint32_t active,
                              bool coherent, struct accel_hit *h) {
    record_packet(r, active, false);
    __real_accel_intersect16(a, r, active, coherent, h);
}

uint32_t __wrap_accel_occluded16(const struct accel *a, const struct ray *r, uint32_t active,
                                bool coherent) {
    record_packet(r, active, true);
    return __real_accel_occluded16(a, r, active, coherent);
}

static double replay(const struct accel *accel, size_t *hits) {
    RTCScene scene = accel_embree_scene(accel);
    *hits = 0;
    accel_thread_init();
    const double start = time_seconds();
#if !EMBREE_4
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
#endif
    for (size_t i = 0; i < record_count; i++) {
        const struct ray *r = &records[i].ray;
        struct RTCRayHit rh = {.ray = {.org_x = r->o[0], .org_y = r->o[1], .org_z = r->o[2],
                                       .dir_x = r->d[0], .dir_y = r->d[1], .dir_z = r->d[2],
                                       .tnear = r->tmin, .tfar = r->tmax, .mask = ~0u}};
        rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if EMBREE_4
        if (records[i].shadow)
            rtcOccluded1(scene, &rh.ray, NULL);
        else
            rtcIntersect1(scene, &rh, NULL);
#else
        if (records[i].shadow)
            rtcOccluded1(scene, &context, &rh.ray);
        else
            rtcIntersect1(scene, &context, &rh);
#endif
        *hits += rh.hit.geomID != RTC_INVALID_GEOMETRY_ID || rh.ray.tfar < 0;
    }
    return time_seconds() - start;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *v, int n) {
    qsort(v, (size_t)n, sizeof *v, ascending);
    return v[n / 2];
}

static double render_once(struct job *job, struct render_result *r) {
    film_destroy(job_render(job, r));
    return r->seconds;
}

int main(int argc, char **argv) {
    enum { REPEATS = 7 };
    int width = 320, height = 180;
    if (argc < 2 || (argc > 2 && sscanf(argv[2], "%dx%d", &width, &height) != 2)) {
        fprintf(stderr, "usage: %s SCENE [WxH] [SPP] [SAMPLER]\n", argv[0]);
        return 2;
    }
    const struct job_options options = {
        .scene = argv[1], .spp = argc > 3 ? atoi(argv[3]) : 4, .threads = 1,
        .reading = {.width = width, .height = height, .sampler = argc > 4 ? argv[4] : NULL}};
    struct job job;
    struct render_result r;
    double render[REPEATS], bare[REPEATS], ratio[REPEATS];
    size_t hits = 0;
    if (!job_open(&job, &options))
        return 1;
    recording = true;
    render_once(&job, &r);
    recording = false;
    for (int i = 0; i < REPEATS; i++) {
        render[i] = render_once(&job, &r);
        bare[i] = replay(job.world->accel, &hits);
        ratio[i] = bare[i] / render[i];
    }
    printf("%s: %.2f rays a path, render %.3f Mpaths/s, bare rays %.2f Mrays/s, "
           "trace efficiency %.3f (%.0f %% of the rays hit)\n", argv[1], (double)record_count / (double)r.paths,
           (double)r.paths / median(render, REPEATS) * 1e-6,
           (double)record_count / median(bare, REPEATS) * 1e-6, median(ratio, REPEATS),
           100 * (double)hits / (double)record_count);
    job_close(&job);
    mem_free(records);
    return 0;
}
