// SPDX-License-Identifier: Apache-2.0
// A shape in an instance has the surface of the same shape moved there without one: positions,
// normals, texture coordinates, tangents, for every kind of shape and transforms of all sorts.
#include "check.h"
#include "math/hash.h"
#include "math/warp.h"
#include "render/picture.h"

enum { RAYS = 2000 };

static const char *const shapes[] = {
    "type='rectangle'", "type='cube'", "type='sphere'", "type='disk'", "type='cylinder'",
};

static const char *const transforms[] = {
    "",
    "<translate x='3' y='-2' z='1'/>",
    "<scale value='1.5'/><translate y='1'/>",
    "<rotate x='1' y='2' z='3' angle='77'/><scale value='0.3'/><translate x='5' z='-2'/>",
    "<scale x='1' y='2' z='0.5'/><rotate y='1' angle='30'/><translate x='1'/>",
};

// The shape has a place of its own, so that the order of the two transforms matters.
static const char own[] = "<scale value='0.7'/><rotate z='1' angle='40'/><translate x='1' y='0.5'/>";

static void open_shape(struct job *job, bool instance, const char *shape, const char *transform) {
    const struct job_options o = {.spp = 1, .threads = 1, .scene = scene_path("scene.xml")};
    char text[1024];
    if (instance)
        snprintf(text, sizeof text,
                 "<scene version='3.0.0'><sensor type='perspective'/><shape type='shapegroup' "
                 "id='g'><shape %s><transform name='to_world'>%s</transform></shape></shape>"
                 "<shape type='instance'><ref id='g'/><transform name='to_world'>%s</transform>"
                 "</shape></scene>", shape, own, transform);
    else
        snprintf(text, sizeof text,
                 "<scene version='3.0.0'><sensor type='perspective'/><shape %s><transform "
                 "name='to_world'>%s%s</transform></shape></scene>", shape, own, transform);
    scene_write("scene.xml", text);
    if (!job_open(job, &o))
        exit(1);
}

static vec3 random_direction(struct rng *r) {
    const float u = rng_float(r);
    return warp_sphere((struct vec2){u, rng_float(r)});
}

static float distance(vec3 a, vec3 b) {
    return length(a - b);
}

static void compare(const char *shape, const char *transform) {
    struct job flat, placed;
    struct rng r = {3};
    int hits = 0, lost = 0;
    float position = 0, normal = 0, tangent = 0, uv = 0;
    open_shape(&flat, false, shape, transform);
    open_shape(&placed, true, shape, transform);
    accel_thread_init();
    for (int i = 0; i < RAYS; i++) {
        const struct world *w = flat.world;
        const vec3 o = w->centre + 3 * w->radius * random_direction(&r);
        const vec3 to = w->centre + 0.5f * w->radius * random_direction(&r);
        const struct ray ray = {o, normalize(to - o), 0, INFINITY};
        struct accel_hit a, b;
        struct surface s, t;
        const bool hit = accel_intersect(w->accel, &ray, &a);
        if (hit != accel_intersect(placed.world->accel, &ray, &b) ||
            (hit && fabsf(a.t - b.t) > 1e-4f * a.t)) {
            lost++; // at an edge
            continue;
        }
        if (!hit)
            continue;
        hits++;
        world_surface(flat.world, &ray, &a, &s);
        world_surface(placed.world, &ray, &b, &t);
        const float du = fabsf(s.point.at.uv.x - t.point.at.uv.x);
        const float dv = fabsf(s.point.at.uv.y - t.point.at.uv.y);
        position = fmaxf(position, distance(s.p, t.p) / w->radius);
        normal = fmaxf(normal, distance(s.ng, t.ng));
        normal = fmaxf(normal, distance(s.point.frame.n, t.point.frame.n));
        tangent = fmaxf(tangent, distance(s.point.dpdu, t.point.dpdu) / length(s.point.dpdu));
        uv = fmaxf(uv, fmaxf(fminf(du, 1 - du), dv)); // u of round shapes has a seam
    }
    printf("%-17s %5d hits, %2d lost; off by %.1e in place, %.1e in normals, %.1e in tangents, "
           "%.1e in uv: %s\n", shape, hits, lost, (double)position, (double)normal,
           (double)tangent, (double)uv, transform);
    CHECK(hits > 200 && lost <= RAYS / 200);
    CHECK(position < 1e-5f && normal < 1e-4f && tangent < 1e-3f && uv < 1e-3f);
    job_close(&flat);
    job_close(&placed);
}

int main(void) {
    scene_folder_open();
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (size_t k = 0; k < sizeof transforms / sizeof *transforms; k++)
            compare(shapes[i], transforms[k]);
    scene_folder_close();
    return check_result();
}
