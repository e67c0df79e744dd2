// SPDX-License-Identifier: Apache-2.0
// The physical limit of a path tracer on this machine: a bare loop of single-ray Embree calls with
// diffuse shading and next event estimation, nothing else, beside the product's own render of the
// same box, on the same threads, in turn.
//
//     bare_loop CORNELL_BOX_SCENE [WxH] [SPP]
//
// The scene must be closed-in meshes with one area light: paths start at the camera, all surfaces
// are grey (0.6), light comes from uniform points of the light's triangles; roulette from depth 5.
#include <stdio.h>
#include <stdlib.h>

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
#include "math/warp.h"

struct bare {
    const struct job *job;
    RTCScene scene;
    const struct shape *light;
    int width, height, spp;
    float *pixels;
    uint64_t rays[64];
};

static bool intersect(RTCScene scene, vec3 o, vec3 d, struct RTCRayHit *rh) {
    rh->ray = (struct RTCRay){.org_x = o[0], .org_y = o[1], .org_z = o[2], .dir_x = d[0],
                              .dir_y = d[1], .dir_z = d[2], .tnear = 1e-4f, .tfar = INFINITY,
                              .mask = ~0u};
    rh->hit.geomID = rh->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if EMBREE_4
    rtcIntersect1(scene, rh, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, rh);
#endif
    return rh->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

static bool occluded(RTCScene scene, vec3 o, vec3 d) {
    struct RTCRay r = {.org_x = o[0], .org_y = o[1], .org_z = o[2], .dir_x = d[0], .dir_y = d[1],
                       .dir_z = d[2], .tnear = 1e-4f, .tfar = 0.9999f, .mask = ~0u};
#if EMBREE_4
    rtcOccluded1(scene, &r, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &r);
#endif
    return r.tfar < 0;
}

// Irradiance-like term of one uniform point of the light, before visibility.
static float light_term(const struct bare *b, struct rng *rng, vec3 p, vec3 n, vec3 *to_light) {
    const struct mesh *m = &b->light->mesh;
    const uint32_t *i = m->indices[rng_u32(rng) % m->triangle_count];
    const vec3 p0 = v3_load(m->positions[i[0]]), e1 = v3_load(m->positions[i[1]]) - p0,
               e2 = v3_load(m->positions[i[2]]) - p0;
    const struct vec2 t = warp_triangle((struct vec2){rng_float(rng), rng_float(rng)});
    const vec3 d = p0 + t.x * e1 + t.y * e2 - p, area = cross(e1, e2);
    const float d2 = length2(d);
    *to_light = d;
    return fmaxf(0, dot(n, d)) * fmaxf(0, -dot(area, d)) * 0.5f * (float)m->triangle_count /
           (d2 * d2);
}

static float path(const struct bare *b, struct rng *rng, vec3 o, vec3 d, uint64_t *rays) {
    float radiance = 0, beta = 1;
    for (int depth = 0; depth < 64; depth++) {
        struct RTCRayHit rh;
        ++*rays;
        if (!intersect(b->scene, o, d, &rh))
            break;
        vec3 n = normalize(v3(rh.hit.Ng_x, rh.hit.Ng_y, rh.hit.Ng_z));
        n = dot(n, d) > 0 ? -n : n;
        o = o + rh.ray.tfar * d;
        vec3 to_light;
        const float term = light_term(b, rng, o, n, &to_light);
        beta *= 0.6f;
        if (term > 0) {
            ++*rays;
            radiance += occluded(b->scene, o, to_light) ? 0 : beta * term * INV_PI;
        }
        if (depth >= 4 && rng_float(rng) > 0.6f)
            break;
        beta *= depth >= 4 ? 1 / 0.6f : 1;
        const struct frame f = frame_from_normal(n);
        d = to_world(&f, warp_cosine_hemisphere((struct vec2){rng_float(rng), rng_float(rng)}));
    }
    return radiance;
}

static void row(void *ctx, size_t y, int worker) {
    struct bare *b = ctx;
    const struct scene *s = b->job->scene;
    accel_thread_init();
    for (int x = 0; x < b->width; x++) {
        struct rng rng = {hash_u64((uint64_t)y * 65536 + (uint64_t)x)};
        float sum = 0;
        for (int i = 0; i < b->spp; i++) {
            struct ray r;
            sensor_type_of(s->sensors[0])->ray(s->sensors[0]->data, (float)x + rng_float(&rng),
                                               (float)y + rng_float(&rng), (struct vec2){0, 0}, &r);
            sum += path(b, &rng, r.o, r.d, &b->rays[worker]);
        }
        b->pixels[y * (size_t)b->width + (size_t)x] = sum;
    }
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    enum { REPEATS = 5 };
    int width = 512, height = 512;
    if (argc < 2 || (argc > 2 && sscanf(argv[2], "%dx%d", &width, &height) != 2)) {
        fprintf(stderr, "usage: %s CORNELL_BOX_SCENE [WxH] [SPP]\n", argv[0]);
        return 2;
    }
    struct job job;
    const struct job_options options = {.scene = argv[1], .spp = argc > 3 ? atoi(argv[3]) : 8,
                                        .reading = {.width = width, .height = height}};
    if (!job_open(&job, &options))
        return 1;
    const uint32_t shape = job.scene->light_count ? job.scene->lights[0].shape : SCENE_NONE;
    if (shape == SCENE_NONE || job.scene->shapes[shape].kind != SHAPE_MESH) {
        fprintf(stderr, "%s: expected an area light on a mesh\n", argv[1]);
        job_close(&job);
        return 1;
    }
    struct bare b = {.job = &job, .scene = accel_embree_scene(job.world->accel),
                     .light = &job.scene->shapes[shape], .width = width, .height = height,
                     .spp = (int)job.render.tracer.spp};
    b.pixels = mem_array((size_t)width * (size_t)height, sizeof *b.pixels);
    const double paths = (double)width * height * b.spp;
    double bare[REPEATS], product[REPEATS];
    uint64_t rays = 0;
    struct render_result r;
    for (int i = 0; i < REPEATS; i++) {
        const double start = time_seconds();
        thread_for(0, (size_t)height, row, &b);
        bare[i] = time_seconds() - start;
        film_destroy(job_render(&job, &r));
        product[i] = r.seconds;
    }
    for (int i = 0; i < 64; i++)
        rays += b.rays[i];
    qsort(bare, REPEATS, sizeof *bare, ascending);
    qsort(product, REPEATS, sizeof *product, ascending);
    const double median = bare[REPEATS / 2], ours = product[REPEATS / 2];
    printf("bare loop: %.3f Mpaths/s, %.2f rays a path, %.2f Mrays/s; relume: %.3f Mpaths/s, "
           "%.2f rays a path; ratio of paths %.2f, of rays %.2f\n", paths / median * 1e-6,
           (double)rays / paths / REPEATS, (double)rays / REPEATS / median * 1e-6,
           paths / ours * 1e-6, (double)(r.rays + r.shadow_rays) / paths, median / ours,
           median / ours * ((double)(r.rays + r.shadow_rays) / ((double)rays / REPEATS)));
    mem_free(b.pixels);
    job_close(&job);
    return 0;
}
