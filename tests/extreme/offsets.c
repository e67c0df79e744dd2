// SPDX-License-Identifier: Apache-2.0
// Rays that leave a surface do not find it again, and rays to a point of a light are not stopped by
// the light: for triangles of any shape, size, place and distance, for instances and quadrics.
//
// Counted over random rays; nothing may be found at all, as origins are moved by a bound of the
// error, not by what is mostly enough.
#include "check.h"
#include "math/hash.h"
#include "math/warp.h"
#include "render/picture.h"

enum { TRIANGLES = 400 };

struct cluster {
    const char *name;
    double size, aspect; // of the triangles: longest edge, shortest over longest
    double spread;       // of their places
    bool axis_aligned;
};

static const struct cluster clusters[] = {
    {"unit triangles", 1, 1, 3, false},
    {"small triangles, wide apart", 0.01, 1, 30, false},
    {"tiny triangles, wide apart", 1e-4, 1, 30, false},
    {"huge triangles", 1e4, 1, 1, false},
    {"slivers 1:1000", 1, 1e-3, 3, false},
    {"slivers 1:1e5", 1, 1e-5, 3, false},
    {"axis-aligned triangles", 1, 1, 3, true},
    {"axis-aligned huge triangles", 1e4, 1, 1e4, true},
};

static double uniform(struct rng *r) {
    return (double)rng_float(r);
}

static vec3 random_direction(struct rng *r) {
    const float u = rng_float(r);
    return warp_sphere((struct vec2){u, rng_float(r)});
}

// OBJ text of random triangles.
static void write_cluster(const struct cluster *c, struct rng *r) {
    static char text[TRIANGLES * 160];
    size_t used = 0;
    for (int i = 0; i < TRIANGLES; i++) {
        double p[3][3];
        const vec3 a = random_direction(r), b = random_direction(r);
        for (int k = 0; k < 3; k++) {
            const double size = c->size * (0.5 + uniform(r));
            const bool flat = c->axis_aligned && k == i % 3;
            p[0][k] = c->spread * (2 * uniform(r) - 1);
            p[1][k] = p[0][k] + (flat ? 0 : (double)a[k] * size);
            p[2][k] = p[1][k] + (flat ? 0 : (double)b[k] * size * c->aspect);
        }
        for (int v = 0; v < 3; v++)
            used += (size_t)snprintf(text + used, sizeof text - used, "v %.9g %.9g %.9g\n", p[v][0],
                                     p[v][1], p[v][2]);
        used += (size_t)snprintf(text + used, sizeof text - used, "f %d %d %d\n", 3 * i + 1,
                                 3 * i + 2, 3 * i + 3);
    }
    scene_write("cluster.obj", text);
}

// ---- rays -----------------------------------------------------------------------------------

struct counts {
    int rays, refound, shadows, blocked;
};

// A point that may lie on the scene: of a random triangle, or anywhere.
static vec3 random_target(const struct world *w, struct rng *r) {
    const struct mesh *m = &w->scene->shapes[0].mesh;
    if (m->triangle_count == 0)
        return w->centre + w->radius * rng_float(r) * random_direction(r);
    const uint32_t *i = m->indices[rng_u32(r) % m->triangle_count];
    const float u = rng_float(r);
    const struct vec2 b = warp_triangle((struct vec2){u, rng_float(r)});
    const vec3 p = (1 - b.x - b.y) * v3_load(m->positions[i[0]]) +
                   b.x * v3_load(m->positions[i[1]]) + b.y * v3_load(m->positions[i[2]]);
    return w->scene->instance_count ? affine_point(&w->instances[rng_u32(r) % 2].forward, p) : p;
}

// A point of a surface as a ray from anywhere finds it.
static bool find_surface(const struct world *w, struct rng *r, struct surface *s) {
    struct accel_hit hit;
    const vec3 o = w->centre + (float)exp(6 * uniform(r) - 2) * w->radius * random_direction(r);
    const struct ray ray = {o, normalize(random_target(w, r) - o), 0, INFINITY};
    if (!accel_intersect(w->accel, &ray, &hit))
        return false;
    world_surface(w, &ray, &hit, s);
    return true;
}

static bool same_place(const struct surface *s, const struct accel_hit *hit) {
    return hit->shape == s->shape && hit->primitive == s->primitive && hit->instance == s->instance;
}

// `convex`: a ray that leaves on the outer side can never come back.
static void leave(const struct world *w, const struct surface *s, bool convex, struct rng *r,
                  struct counts *n) {
    vec3 d = random_direction(r);
    struct accel_hit hit;
    if (convex && dot(d, s->ng) < 0)
        d = -d;
    const struct ray ray = {surface_offset(s, d), d, 0, INFINITY};
    n->rays++;
    n->refound += accel_intersect(w->accel, &ray, &hit) && same_place(s, &hit);
}

// Whether p lies in the plane of a triangle: then it is on that triangle, as no two of a cluster
// are in one plane.
static bool is_on(const struct world *w, uint32_t shape, uint32_t primitive, vec3 p) {
    const struct mesh *m = &w->scene->shapes[shape].mesh;
    const uint32_t *i = m->indices[primitive];
    const vec3 a = v3_load(m->positions[i[0]]), b = v3_load(m->positions[i[1]]),
               c = v3_load(m->positions[i[2]]);
    const vec3 n = normalize(cross(b - a, c - a));
    return fabsf(dot(n, p - a)) < 1e-6f * (length(b - a) + length(a));
}

static void connect(const struct world *w, const struct surface *s, struct rng *r,
                    struct counts *n) {
    struct light_sample l;
    struct accel_hit hit;
    const float u = rng_float(r);
    const struct vec2 v = {u, rng_float(r)};
    if (w->light_count == 0 || !w->lights[0].type->sample(w->lights[0].data, s->p, v, &l))
        return;
    if (fabsf(dot(s->ng, l.n)) > 0.9999f)
        return; // most likely the triangle itself
    const struct ray ray = world_shadow_ray(s, &l);
    n->shadows++;
    if (accel_intersect(w->accel, &ray, &hit))
        n->blocked += same_place(s, &hit) || is_on(w, hit.shape, hit.primitive, l.p);
}

static struct counts count(const char *shapes, bool convex) {
    const int rays = full_mode() ? 2000000 : 100000;
    const struct job_options o = {.spp = 1, .threads = 1, .scene = scene_path("scene.xml")};
    struct counts n = {0};
    struct rng r = {7};
    struct job job;
    char text[2048];
    snprintf(text, sizeof text, "<scene version='3.0.0'><sensor type='perspective'/>%s</scene>",
             shapes);
    scene_write("scene.xml", text);
    if (!job_open(&job, &o))
        exit(1);
    accel_thread_init();
    for (int i = 0; i < 4 * rays && n.rays < rays; i++) {
        struct surface s;
        if (!find_surface(job.world, &r, &s))
            continue;
        leave(job.world, &s, convex, &r, &n);
        if (!convex)
            connect(job.world, &s, &r, &n);
    }
    job_close(&job);
    return n;
}

static void report(const char *name, const struct counts *n) {
    printf("%-40s %8d rays, %6d found their surface; %8d to lights, %6d blocked by it\n", name,
           n->rays, n->refound, n->shadows, n->blocked);
    CHECK(n->rays > 1000);
    CHECK(n->refound == 0);
    CHECK(n->blocked * 200000.0 <= n->shadows); // two planes may coincide by chance
}

static const char mesh[] =
    "<shape type='obj'><string name='filename' value='cluster.obj'/><transform name='to_world'>"
    "%s</transform><emitter type='area'/></shape>";
static const char instance[] =
    "<shape type='shapegroup' id='g'><shape type='obj'><string name='filename' "
    "value='cluster.obj'/></shape></shape><shape type='instance'><ref id='g'/>"
    "<transform name='to_world'>%s</transform></shape>"
    "<shape type='instance'><ref id='g'/></shape>";

int main(void) {
    struct rng r = {1};
    char text[1024], name[96];
    scene_folder_open();
    for (size_t i = 0; i < sizeof clusters / sizeof *clusters; i++) {
        struct counts n;
        write_cluster(&clusters[i], &r);
        snprintf(text, sizeof text, mesh, "");
        n = count(text, false);
        report(clusters[i].name, &n);
        snprintf(text, sizeof text, instance,
                 "<rotate x='1' y='2' z='3' angle='77'/><scale value='0.3'/>"
                 "<translate x='50' y='-20' z='10'/>");
        n = count(text, false);
        snprintf(name, sizeof name, "%s, instances", clusters[i].name);
        report(name, &n);
    }
    const char *const quadrics[] = {
        "<shape type='sphere'/>",
        "<shape type='sphere'><float name='radius' value='1e-3'/>"
        "<point name='center' x='0.5' y='0.7' z='0.9'/></shape>"
        "<shape type='sphere'><point name='center' x='-9'/></shape>",
        "<shape type='sphere'><transform name='to_world'><scale x='1' y='10' z='0.1'/>"
        "<rotate x='1' y='1' angle='20'/><translate x='5'/></transform></shape>",
        "<shape type='disk'><transform name='to_world'><rotate x='1' y='2' angle='50'/>"
        "<translate x='3' y='1'/></transform></shape>",
        "<shape type='shapegroup' id='g'><shape type='sphere'><point name='center' x='2' y='1'/>"
        "</shape><shape type='disk'/></shape><shape type='instance'><ref id='g'/>"
        "<transform name='to_world'><rotate x='1' y='2' z='3' angle='77'/><scale value='0.6'/>"
        "<translate x='-2' y='-1' z='1'/></transform></shape>"
        "<shape type='instance'><ref id='g'/></shape>",
    };
    for (size_t i = 0; i < sizeof quadrics / sizeof *quadrics; i++) {
        const struct counts n = count(quadrics[i], true);
        snprintf(name, sizeof name, "quadrics %zu", i);
        report(name, &n);
    }
    scene_folder_close();
    return check_result();
}
