// SPDX-License-Identifier: Apache-2.0
// Rays that leave a surface do not find it again, and rays to a point of a light are stopped neither
// by the light nor by the surface they leave: for triangles of any shape, size, place and distance,
// for instances and quadrics.
//
// Counted over random rays; nothing may be found at all, as origins are moved by a bound of the
// error, not by what is mostly enough. But on which triangle of a light its point lies is told by
// planes, and two may meet there by chance: of these shadow rays 1 in 200 000 may be stopped, none in
// a short run.
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
    bool by_plane; // the light is of triangles
};

static bool is_quadric(const struct world *w, uint32_t shape) {
    return w->scene->shapes[shape].kind != SHAPE_MESH;
}

// NULL: there are quadrics only.
static const struct mesh *find_mesh(const struct world *w) {
    for (uint32_t i = 0; i < w->scene->shape_count; i++)
        if (!is_quadric(w, i))
            return &w->scene->shapes[i].mesh;
    return NULL;
}

// A point that may lie on the scene: of a random triangle, or anywhere.
static vec3 random_target(const struct world *w, struct rng *r) {
    const struct mesh *m = find_mesh(w);
    if (!m)
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

// Quadrics are convex: a ray that leaves on the outer side can never come back.
static void leave(const struct world *w, const struct surface *s, struct rng *r, struct counts *n) {
    vec3 d = random_direction(r);
    struct accel_hit hit;
    if (is_quadric(w, s->shape) && dot(d, s->ng) < 0)
        d = -d;
    const struct ray ray = {surface_offset(s, d), d, 0, INFINITY};
    n->rays++;
    n->refound += accel_intersect(w->accel, &ray, &hit) && same_place(s, &hit);
}

// Whether p lies in the plane of a triangle: then it is on that triangle, as no two of a cluster
// are in one plane.
static bool is_on(const struct mesh *m, uint32_t primitive, vec3 p) {
    const uint32_t *i = m->indices[primitive];
    const vec3 a = v3_load(m->positions[i[0]]), b = v3_load(m->positions[i[1]]),
               c = v3_load(m->positions[i[2]]);
    const vec3 n = normalize(cross(b - a, c - a));
    return fabsf(dot(n, p - a)) < 1e-6f * (length(b - a) + length(a));
}

// Whether the ray to the point p of the light has met the light there; the ray to the near side of a
// quadric meets it nowhere.
static bool is_stopped_by_light(const struct world *w, const struct accel_hit *hit, vec3 p) {
    const uint32_t light = w->scene->lights[0].shape;
    return hit->shape == light &&
           (is_quadric(w, light) || is_on(&w->scene->shapes[light].mesh, hit->primitive, p));
}

// Whether a ray may leave the surface that way: not into a quadric, nor from one that is the light.
static bool may_be_lit(const struct world *w, const struct surface *s, const struct light_sample *l) {
    const uint32_t light = w->scene->lights[0].shape;
    if (is_quadric(w, s->shape))
        return s->shape != light && dot(s->ng, l->wi) > 0;
    if (is_quadric(w, light))
        return fabsf(dot(s->ng, l->wi)) > 1e-5f; // else rounding decides on which side the light is
    return fabsf(dot(s->ng, l->n)) <= 0.9999f; // else most likely the triangle itself
}

static void connect(const struct world *w, const struct surface *s, struct rng *r,
                    struct counts *n) {
    struct light_sample l;
    struct accel_hit hit;
    const float u = rng_float(r);
    const struct vec2 v = {u, rng_float(r)};
    if (!w->lights[0].type->sample(w->lights[0].data, s->p, v, &l) || !may_be_lit(w, s, &l))
        return;
    const struct ray ray = world_shadow_ray(s, &l);
    n->shadows++;
    if (accel_intersect(w->accel, &ray, &hit))
        n->blocked += same_place(s, &hit) || is_stopped_by_light(w, &hit, l.p);
}

static struct counts count(const char *shapes) {
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
    n.by_plane = !is_quadric(job.world, job.scene->lights[0].shape);
    accel_thread_init();
    for (int i = 0; i < 4 * rays && n.rays < rays; i++) {
        struct surface s;
        if (!find_surface(job.world, &r, &s))
            continue;
        leave(job.world, &s, &r, &n);
        connect(job.world, &s, &r, &n);
    }
    job_close(&job);
    return n;
}

static void report(const char *name, const struct counts *n) {
    printf("%-40s %8d rays, %6d found their surface; %8d to lights, %6d blocked by it\n", name,
           n->rays, n->refound, n->shadows, n->blocked);
    CHECK(n->rays > 1000 && n->shadows > 1000);
    CHECK(n->refound == 0);
    CHECK(n->by_plane ? n->blocked * 200000.0 <= n->shadows : n->blocked == 0);
}

#define LIGHT                                                                                      \
    "<shape type='sphere'><point name='center' x='20' y='30' z='-10'/><emitter type='area'/></shape>"

static const char mesh[] =
    "<shape type='obj'><string name='filename' value='cluster.obj'/><transform name='to_world'>"
    "%s</transform><emitter type='area'/></shape>";
static const char instance[] =
    "<shape type='shapegroup' id='g'><shape type='obj'><string name='filename' "
    "value='cluster.obj'/></shape></shape><shape type='instance'><ref id='g'/>"
    "<transform name='to_world'>%s</transform></shape>"
    "<shape type='instance'><ref id='g'/></shape>" LIGHT;

int main(void) {
    struct rng r = {1};
    char text[1024], name[96];
    scene_folder_open();
    for (size_t i = 0; i < sizeof clusters / sizeof *clusters; i++) {
        struct counts n;
        write_cluster(&clusters[i], &r);
        snprintf(text, sizeof text, mesh, "");
        n = count(text);
        report(clusters[i].name, &n);
        snprintf(text, sizeof text, instance,
                 "<rotate x='1' y='2' z='3' angle='77'/><scale value='0.3'/>"
                 "<translate x='50' y='-20' z='10'/>");
        n = count(text);
        snprintf(name, sizeof name, "%s, instances", clusters[i].name);
        report(name, &n);
    }
    // A light, then what it lights.
    const char *const quadrics[] = {
        "<shape type='sphere'><emitter type='area'/></shape>"
        "<shape type='sphere'><point name='center' x='3' y='1'/></shape>",
        "<shape type='sphere'><float name='radius' value='1e-3'/>"
        "<point name='center' x='0.5' y='0.7' z='0.9'/><emitter type='area'/></shape>"
        "<shape type='sphere'><point name='center' x='-9'/></shape>",
        "<shape type='sphere'><transform name='to_world'><scale x='1' y='10' z='0.1'/>"
        "<rotate x='1' y='1' angle='20'/><translate x='5'/></transform><emitter type='area'/></shape>"
        "<shape type='disk'/>",
        "<shape type='disk'><transform name='to_world'><rotate x='1' y='2' angle='50'/>"
        "<translate x='3' y='1'/></transform><emitter type='area'/></shape>"
        "<shape type='sphere'><point name='center' x='4' y='3' z='3'/></shape>",
        "<shape type='cylinder'><transform name='to_world'><scale value='0.3'/>"
        "<rotate x='1' y='2' angle='50'/><translate x='3' y='1'/></transform>"
        "<emitter type='area'/></shape><shape type='cylinder'/>",
        "<shape type='shapegroup' id='g'><shape type='sphere'><point name='center' x='2' y='1'/>"
        "</shape><shape type='disk'/></shape><shape type='instance'><ref id='g'/>"
        "<transform name='to_world'><rotate x='1' y='2' z='3' angle='77'/><scale value='0.6'/>"
        "<translate x='-2' y='-1' z='1'/></transform></shape>"
        "<shape type='instance'><ref id='g'/></shape>"
        "<shape type='sphere'><point name='center' y='4' z='2'/><emitter type='area'/></shape>",
    };
    for (size_t i = 0; i < sizeof quadrics / sizeof *quadrics; i++) {
        const struct counts n = count(quadrics[i]);
        snprintf(name, sizeof name, "quadrics %zu", i);
        report(name, &n);
    }
    scene_folder_close();
    return check_result();
}
