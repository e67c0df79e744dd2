// SPDX-License-Identifier: Apache-2.0
// What 16-wide packets are worth against single rays, on one thread, in turn.
//
//     packets SCENE [WxH]
//
// Prints millions of rays per second for the camera's rays and for the shadow rays of neighbouring
// pixels' first hits, and the time of a whole frame (layers only; paths) with and without packets.
// The linker wraps the packet queries (--wrap), so switching them off costs the product nothing.
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/thread.h"
#include "driver/job.h"

static bool singles; // packets are traced ray by ray

void __real_accel_intersect16(const struct accel *, const struct ray *, uint32_t, bool, struct accel_hit *);
uint32_t __real_accel_occluded16(const struct accel *, const struct ray *, uint32_t, bool);
void __wrap_accel_intersect16(const struct accel *, const struct ray *, uint32_t, bool, struct accel_hit *);
uint32_t __wrap_accel_occluded16(const struct accel *, const struct ray *, uint32_t, bool);

void __wrap_accel_intersect16(const struct accel *a, const struct ray *r, uint32_t active,
                              bool coherent, struct accel_hit *h) {
    if (!singles)
        __real_accel_intersect16(a, r, active, coherent, h);
    for (int i = 0; singles && i < ACCEL_PACKET; i++)
        if (active >> i & 1)
            accel_intersect(a, &r[i], &h[i]);
}

uint32_t __wrap_accel_occluded16(const struct accel *a, const struct ray *r, uint32_t active,
                                bool coherent) {
    uint32_t blocked = 0;
    if (!singles)
        return __real_accel_occluded16(a, r, active, coherent);
    for (int i = 0; i < ACCEL_PACKET; i++)
        if (active >> i & 1)
            blocked |= (uint32_t)accel_occluded(a, &r[i]) << i;
    return blocked;
}

struct rays {
    struct ray *camera, *shadow;
    uint32_t *pending; // per packet
    size_t packets;
};

// The camera's rays in packets of 4x4 pixels, and a shadow ray from each first hit.
static void make_rays(const struct job *job, int width, int height, struct rays *out) {
    const struct object *sensor = job->scene->sensors[0];
    const struct world *w = job->world;
    struct rng rng = {1};
    out->packets = (size_t)(width / 4) * (size_t)(height / 4);
    out->camera = mem_array(out->packets * ACCEL_PACKET, sizeof *out->camera);
    out->shadow = mem_array(out->packets * ACCEL_PACKET, sizeof *out->shadow);
    out->pending = mem_array(out->packets, sizeof *out->pending);
    for (size_t k = 0; k < out->packets * ACCEL_PACKET; k++) {
        const int block = (int)(k / ACCEL_PACKET), i = (int)(k % ACCEL_PACKET);
        const int x = block % (width / 4) * 4 + i % 4, y = block / (width / 4) * 4 + i / 4;
        struct ray *r = &out->camera[k];
        struct accel_hit hit;
        struct surface s;
        struct light_sample l;
        uint32_t light;
        sensor_type_of(sensor)->ray(sensor->data, (float)x + rng_float(&rng),
                                    (float)y + rng_float(&rng), (struct vec2){0.5f, 0.5f}, r);
        const float choice = rng_float(&rng);
        const struct vec2 u = {rng_float(&rng), rng_float(&rng)};
        if (!accel_intersect(w->accel, r, &hit))
            continue;
        world_surface(w, r, &hit, &s);
        if (!world_sample_light(w, &(struct light_place){.p = s.p}, choice, u, &light, &l))
            continue;
        out->shadow[k] = world_shadow_ray(&s, &l);
        out->pending[block] |= 1u << i;
    }
}

static double time_camera(const struct accel *a, const struct rays *r) {
    struct accel_hit hits[ACCEL_PACKET];
    const double start = time_seconds();
    for (size_t k = 0; k < r->packets; k++)
        __wrap_accel_intersect16(a, r->camera + k * ACCEL_PACKET, 0xffff, true, hits);
    return time_seconds() - start;
}

static double time_shadow(const struct accel *a, const struct rays *r, uint64_t *blocked) {
    *blocked = 0;
    const double start = time_seconds();
    for (size_t k = 0; k < r->packets; k++)
        *blocked += (uint64_t)__builtin_popcount(
            __wrap_accel_occluded16(a, r->shadow + k * ACCEL_PACKET, r->pending[k], true));
    return time_seconds() - start;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

enum { REPEATS = 9 };

static double median(double v[REPEATS]) {
    qsort(v, REPEATS, sizeof *v, ascending);
    return v[REPEATS / 2];
}

static void compare_stages(const struct job *job, int width, int height) {
    struct rays r;
    double camera[2][REPEATS], shadow[2][REPEATS];
    uint64_t pending = 0, blocked = 0;
    make_rays(job, width, height, &r);
    for (size_t k = 0; k < r.packets; k++)
        pending += (uint64_t)__builtin_popcount(r.pending[k]);
    for (int i = 0; i < 2 * REPEATS; i++) {
        singles = i % 2;
        camera[singles][i / 2] = time_camera(job->world->accel, &r);
        shadow[singles][i / 2] = time_shadow(job->world->accel, &r, &blocked);
    }
    const double rays = (double)(r.packets * ACCEL_PACKET) * 1e-6, tests = (double)pending * 1e-6;
    const double c[2] = {median(camera[0]), median(camera[1])};
    const double s[2] = {median(shadow[0]), median(shadow[1])};
    printf("  camera rays:  packets %6.2f, single %6.2f Mrays/s, ratio %.2f\n", rays / c[0],
           rays / c[1], c[1] / c[0]);
    if (pending)
        printf("  first shadow: packets %6.2f, single %6.2f Mrays/s, ratio %.2f "
               "(%.0f %% blocked)\n", tests / s[0], tests / s[1], s[1] / s[0],
               100 * (double)blocked / (double)pending);
    mem_free(r.camera);
    mem_free(r.shadow);
    mem_free(r.pending);
}

static bool compare_frames(const char *scene, const char *integrator, int width, int height) {
    const struct job_options options = {
        .scene = scene, .spp = 4, .threads = 1, .aovs = "albedo,N,Z",
        .reading = {.width = width, .height = height, .integrator = integrator, .lenient = true}};
    struct job job;
    struct render_result r;
    double seconds[2][REPEATS];
    if (!job_open(&job, &options))
        return false;
    for (int i = 0; i < 2 * REPEATS; i++) {
        singles = i % 2;
        film_destroy(job_render(&job, &r));
        seconds[singles][i / 2] = r.seconds;
    }
    const double t[2] = {median(seconds[0]), median(seconds[1])};
    printf("  %-4s frame:   packets %6.3f, single %6.3f s, ratio %.2f\n", integrator, t[0], t[1],
           t[1] / t[0]);
    job_close(&job);
    return true;
}

int main(int argc, char **argv) {
    int width = 320, height = 240;
    if (argc < 2 || (argc > 2 && sscanf(argv[2], "%dx%d", &width, &height) != 2)) {
        fprintf(stderr, "usage: %s SCENE [WxH]\n", argv[0]);
        return 2;
    }
    const struct job_options options = {
        .scene = argv[1], .reading = {.width = width, .height = height, .lenient = true}};
    struct job job;
    log_set_level(LOG_WARN);
    accel_thread_init();
    if (!job_open(&job, &options))
        return 1;
    printf("%s: %llu triangles, %.1f MB acceleration structure\n", argv[1],
           (unsigned long long)job.triangles, (double)accel_bytes(job.world->accel) * 1e-6);
    compare_stages(&job, width, height);
    job_close(&job);
    return compare_frames(argv[1], "aov", width, height) &&
                   compare_frames(argv[1], "path", width, height)
               ? 0
               : 1;
}
