// SPDX-License-Identifier: Apache-2.0
// What choosing a light costs: on one thread, at the points that the camera's rays meet.
//
//     light_choice SCENE
//
// Prints, for each way of choosing, nanoseconds for a light sample and for the density of a hit, as
// the paths of all lanes together pay them and (in brackets) one alone, the variance of what a sample says of the irradiance without shadows (relative to its square, the mean
// over the points; a sample costs its time times this to equal error), and seconds and bytes of
// making it ready.
#include <stdio.h>
#include <time.h>

#include "base/mem.h"
#include "driver/job.h"
#include "math/hash.h"
#include "world/light_lanes.h"

enum { WIDTH = 160, HEIGHT = 120, REPEATS = 8, VARIANCE_STRIDE = 16, VARIANCE_SAMPLES = 512 };

struct places {
    struct light_place *at;
    int count;
};

static struct places find_places(const struct job *job) {
    const struct object *sensor = job->scene->sensors[0];
    struct places p = {.at = mem_array(WIDTH * HEIGHT, sizeof *p.at)};
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        struct ray ray;
        struct accel_hit hit;
        struct surface s;
        sensor_type_of(sensor)->ray(sensor->data, (float)(k % WIDTH) + 0.5f,
                                    (float)(k / WIDTH) + 0.5f, (struct vec2){0.5f, 0.5f}, &ray);
        if (!accel_intersect(job->world->accel, &ray, &hit))
            continue;
        world_surface(job->world, &ray, &hit, &s);
        const vec3 n = s.point.frame.n;
        p.at[p.count++] = (struct light_place){s.p, dot(n, ray.d) > 0 ? -n : n};
    }
    p.count -= p.count % WIDE_LANES;
    return p;
}

// Of this thread, so that other programs disturb less.
static double cpu_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// A sample for each place, as the path tracer takes them: one by one, or WIDE_LANES together.
struct samples {
    struct light_hit *hits;
    uint32_t *found; // the light, or SCENE_NONE
};

static void sample_alone(const struct world *w, const struct places *p, struct rng *rng,
                         struct samples *out) {
    for (int i = 0; i < p->count; i++) {
        struct light_sample l = {.wi = v3(0, 0, 1)};
        const float u1 = rng_float(rng);
        const struct vec2 u2 = {rng_float(rng), rng_float(rng)};
        out->found[i] = SCENE_NONE;
        if (!world_sample_light(w, &p->at[i], u1, u2, &out->found[i], &l))
            out->found[i] = SCENE_NONE;
        out->hits[i] = (struct light_hit){.wi = l.wi, .distance = l.distance, .ng = l.n};
    }
}

static void sample_lanes(const struct world *w, const struct places *p, int first,
                           struct rng *rng, struct samples *out) {
    struct light_lanes l;
    struct wide3 at, side;
    wide u1, u2[2];
    for (int i = 0; i < WIDE_LANES; i++) {
        wide3_set_lane(&at, i, p->at[first + i].p);
        wide3_set_lane(&side, i, p->at[first + i].n);
        u1[i] = rng_float(rng);
        u2[0][i] = rng_float(rng);
        u2[1][i] = rng_float(rng);
    }
    const uint32_t lit = world_sample_lights(w, WIDE_ALL, &at, &side, u1, u2, &l);
    for (int i = 0; i < WIDE_LANES; i++) {
        out->found[first + i] = lit >> i & 1 ? l.light[i] : SCENE_NONE;
        out->hits[first + i] = (struct light_hit){.wi = wide3_lane(&l.s.wi, i),
                                                  .distance = l.s.distance[i],
                                                  .ng = wide3_lane(&l.s.n, i)};
    }
}

// Nanoseconds for one.
static double time_samples(const struct world *w, const struct places *p, bool together,
                           struct samples *out) {
    struct rng rng = {1};
    const double start = cpu_seconds();
    for (int r = 0; r < REPEATS; r++) {
        if (!together)
            sample_alone(w, p, &rng, out);
        for (int i = 0; together && i < p->count; i += WIDE_LANES)
            sample_lanes(w, p, i, &rng, out);
    }
    return (cpu_seconds() - start) * 1e9 / (REPEATS * (double)p->count);
}

static bool has_density(const struct world *w, uint32_t light) {
    return light != SCENE_NONE && !w->lights[light].type->delta;
}

// As the paths of all lanes do that have met lights, on any of their triangles.
static size_t sum_densities(const struct world *w, const struct places *p, bool together, int first,
                            struct rng *rng, const struct samples *s, double *sum) {
    uint32_t triangle[WIDE_LANES], from[WIDE_LANES], triangles[WIDE_LANES];
    size_t n = 0;
    for (int i = 0; i < WIDE_LANES; i++) {
        const uint32_t light = s->found[first + i];
        triangle[i] = light != SCENE_NONE && w->lights[light].parts
                          ? rng_u32(rng) % w->lights[light].parts : 0;
        from[n] = light;
        triangles[n] = triangle[i];
        n += has_density(w, light);
    }
    if (together)
        world_prefetch_lights(w, from, triangles, (int)n);
    for (int i = 0; i < WIDE_LANES; i++) {
        const uint32_t light = s->found[first + i];
        struct light_hit hit = s->hits[first + i];
        if (!has_density(w, light))
            continue;
        hit.at.triangle = triangle[i];
        *sum += (double)world_light_pdf_sa(w, light, &p->at[first + i], &hit);
    }
    return n;
}

static double time_densities(const struct world *w, const struct places *p, bool together,
                             const struct samples *s) {
    struct rng rng = {2};
    double sum = 0;
    size_t n = 0;
    const double start = cpu_seconds();
    for (int r = 0; r < REPEATS; r++)
        for (int i = 0; i < p->count; i += WIDE_LANES)
            n += sum_densities(w, p, together, i, &rng, s, &sum);
    const double seconds = cpu_seconds() - start;
    return n > 0 && sum >= 0 ? seconds * 1e9 / (double)n : 0;
}

// Nodes of the tree that a choice looks at, in the mean.
static double nodes_visited(const struct light_tree *t, const struct places *p) {
    struct rng rng = {3};
    size_t nodes = 0, choices = 0;
    for (int i = 0; i < p->count; i++) {
        const struct light_leaf *leaf;
        float pmf;
        if (!light_tree_choose(t, &p->at[i], (double)rng_float(&rng), &leaf, &pmf))
            continue;
        choices++;
        nodes += (size_t)light_tree_depth(t, leaf->item);
    }
    return choices ? (double)nodes / (double)choices : 0;
}

static double variance_at(const struct world *w, const struct light_place *at, struct rng *rng) {
    double sum = 0, squares = 0;
    for (int i = 0; i < VARIANCE_SAMPLES; i++) {
        struct light_sample l;
        uint32_t light;
        const float u1 = rng_float(rng);
        const struct vec2 u2 = {rng_float(rng), rng_float(rng)};
        if (!world_sample_light(w, at, u1, u2, &light, &l))
            continue;
        const double e = (double)(maxf(dot(l.wi, at->n), 0) / l.pdf_sa * spectrum_mean(l.emission));
        sum += e;
        squares += e * e;
    }
    return sum > 0 ? VARIANCE_SAMPLES * squares / (sum * sum) - 1 : 0;
}

static double mean_variance(const struct world *w, const struct places *p) {
    struct rng rng = {4};
    double sum = 0;
    for (int i = 0; i < p->count; i += VARIANCE_STRIDE)
        sum += variance_at(w, &p->at[i], &rng);
    return sum / ((double)p->count / VARIANCE_STRIDE);
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: light_choice SCENE\n");
        return 2;
    }
    const struct job_options options = {.scene = argv[1], .spp = 1,
                                        .reading = {.width = WIDTH, .height = HEIGHT,
                                                    .lenient = true}};
    struct job job;
    if (!job_open(&job, &options))
        return 1;
    struct places p = find_places(&job);
    struct samples s = {mem_array((size_t)p.count, sizeof *s.hits),
                        mem_array((size_t)p.count, sizeof *s.found)};
    for (int mode = LIGHT_CHOICE_TREE; mode <= LIGHT_CHOICE_UNIFORM; mode++) {
        const double start = cpu_seconds();
        world_choose_lights(job.world, (enum light_choice_mode)mode);
        const double ready = cpu_seconds() - start;
        const double sample[2] = {time_samples(job.world, &p, false, &s),
                                  time_samples(job.world, &p, true, &s)};
        const double density[2] = {time_densities(job.world, &p, false, &s),
                                   time_densities(job.world, &p, true, &s)};
        printf("  %-8s %5.0f (%.0f) ns a sample, %5.0f (%.0f) ns a density, variance %.3g, ready in "
               "%.3f s, %zu bytes",
               light_choice_modes[mode], sample[1], sample[0], density[1], density[0],
               mean_variance(job.world, &p), ready, light_choice_bytes(&job.world->choice));
        if (job.world->choice.has_tree)
            printf(", %.1f nodes", nodes_visited(&job.world->choice.tree, &p));
        printf("\n");
    }
    mem_free(p.at);
    mem_free(s.hits);
    mem_free(s.found);
    job_close(&job);
    return 0;
}
