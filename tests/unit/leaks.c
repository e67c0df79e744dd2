// SPDX-License-Identifier: Apache-2.0
// How many rays leave a closed mesh between its triangles: none, or few where the scene allows it.
// Shadow rays that pass the facets first that block most are blocked as others are.
#include <string.h>

#include "accel/accel.h"
#include "base/mem.h"
#include "check.h"
#include "math/hash.h"
#include "math/warp.h"
#include "scene_text.h"

enum { AROUND = 48, UP = 24 };

static vec3 random_point(struct rng *r, float size) {
    return size * v3(2 * rng_float(r) - 1, 2 * rng_float(r) - 1, 2 * rng_float(r) - 1);
}

static void corner(int i, int j, double p[3]) {
    const double theta = M_PI * j / UP, phi = 2 * M_PI * (i % AROUND) / AROUND;
    p[0] = sin(theta) * cos(phi);
    p[1] = cos(theta);
    p[2] = sin(theta) * sin(phi);
}

// A unit sphere of triangles that share their vertices.
static void write_globe(void) {
    FILE *f = fopen(scene_path("globe.obj"), "w");
    if (!f)
        exit(1);
    for (int j = 0; j <= UP; j++)
        for (int i = 0; i < AROUND; i++) {
            double p[3];
            corner(i, j, p);
            fprintf(f, "v %.9g %.9g %.9g\n", p[0], p[1], p[2]);
        }
    for (int j = 0; j < UP; j++)
        for (int i = 0; i < AROUND; i++) {
            const int a = j * AROUND + i + 1, b = j * AROUND + (i + 1) % AROUND + 1;
            fprintf(f, "f %d %d %d\nf %d %d %d\n", a, b, b + AROUND, a, b + AROUND, a + AROUND);
        }
    fclose(f);
}

static struct accel *accel_of(const char *body, bool may_leak, struct scene **scene) {
    *scene = scene_parse(body);
    if (!*scene)
        exit(1);
    (*scene)->may_leak |= may_leak;
    CHECK((*scene)->may_leak == may_leak);
    struct accel *a = accel_create(*scene, 1);
    if (!a)
        exit(1);
    CHECK(!accel_mixes_packets(a));
    return a;
}

// kind 0: anywhere; 1: towards edges; 2: towards corners
static double leaking(const struct accel *a, const struct mesh *m, int kind, long n) {
    struct rng rng = {(uint64_t)kind + 5};
    long lost = 0;
    for (long k = 0; k < n; k++) {
        const uint32_t *t = m->indices[rng_u32(&rng) % m->triangle_count];
        const float *p = m->positions[t[0]], *q = m->positions[t[1]];
        const float s = kind == 2 ? 0 : rng_float(&rng);
        const vec3 o = random_point(&rng, 0.5f);
        const vec3 to = v3(p[0], p[1], p[2]) + s * (v3(q[0], q[1], q[2]) - v3(p[0], p[1], p[2]));
        const struct ray ray = {o, kind == 0 ? random_point(&rng, 1) : to - o, 0, INFINITY};
        struct accel_hit hit;
        lost += !accel_intersect(a, &ray, &hit) || !accel_occluded(a, &ray);
    }
    printf("  %ld rays %s: %ld lost\n", n, kind == 0 ? "anywhere" : kind == 1 ? "towards edges" :
           "towards corners", lost);
    return (double)lost / (double)n;
}

// Embree lets some rays through that aim at a corner, watertight or not.
static void few_leak(bool may_leak, long n) {
    char body[256];
    struct scene *s;
    snprintf(body, sizeof body, "<boolean name='embree_use_robust_intersections' value='%s'/>"
             "<shape type='obj'><string name='filename' value='globe.obj'/></shape>",
             may_leak ? "false" : "true");
    struct accel *a = accel_of(body, may_leak, &s);
    printf("%s\n", may_leak ? "may leak" : "watertight");
    const struct mesh *m = &s->shapes[0].mesh;
    const double anywhere = leaking(a, m, 0, n), edges = leaking(a, m, 1, 100000),
                 corners = leaking(a, m, 2, 100000);
    if (may_leak)
        CHECK(anywhere < 1e-5 && edges < 0.1 && corners < 0.5);
    else
        CHECK(anywhere == 0 && edges == 0 && corners < 0.01);
    accel_destroy(a);
    scene_destroy(s);
}

static struct ray random_ray(struct rng *r, float most) {
    const vec3 o = random_point(r, 3);
    return (struct ray){o, random_point(r, 1), 0, most};
}

static void learn_blockers(struct accel *a, const struct scene *s) {
    enum { PROBES = 500 };
    struct ray rays[PROBES];
    struct rng rng = {21};
    for (int k = 0; k < PROBES; k++)
        rays[k] = random_ray(&rng, INFINITY);
    accel_learn_blockers(a, s, rays, PROBES);
}

// Rays through edges may differ.
static void blockers_first(void) {
    struct scene *s;
    struct accel *a = accel_of(
        "<shape type='obj'><string name='filename' value='globe.obj'/></shape>"
        "<shape type='rectangle'><transform name='to_world'><scale value='4'/>"
        "<rotate x='1' y='0.2' angle='70'/><translate y='-0.5'/></transform></shape>"
        "<shape type='rectangle'><transform name='to_world'><scale value='3'/>"
        "<rotate y='1' angle='20'/><translate z='-2'/></transform></shape>", false, &s);
    learn_blockers(a, s);
    struct rng rng = {9};
    int blocked = 0, different = 0;
    for (int k = 0; k < 400; k++) {
        enum { MOST = 600 };
        struct ray rays[MOST];
        bool found[MOST];
        const uint32_t count = k % 3 ? MOST : rng_u32(&rng) % MOST;
        for (uint32_t i = 0; i < count; i++)
            rays[i] = random_ray(&rng, i % 2 ? INFINITY : 4 * rng_float(&rng));
        accel_occluded_each(a, rays, count, found);
        for (uint32_t i = 0; i < count; i++) {
            bool alone;
            accel_occluded_each(a, &rays[i], 1, &alone);
            CHECK(alone == found[i]);
            blocked += found[i];
            different += found[i] != accel_occluded(a, &rays[i]);
        }
    }
    printf("%d blocked, %d differ\n", blocked, different);
    CHECK(blocked > 30000 && different < 10);
    accel_destroy(a);
    scene_destroy(s);
}

int main(void) {
    const long n = getenv("RELUME_TEST_FULL") ? 100000000 : 100000;
    scene_folder_open();
    accel_thread_init();
    write_globe();
    few_leak(false, n);
    few_leak(true, n);
    blockers_first();
    scene_folder_close();
    return check_result();
}
