// SPDX-License-Identifier: Apache-2.0
// Small scenes are traced against every primitive: the same hits as through Embree's tree, which
// single rays take, and nothing gets out of a closed box between its triangles.
#include "accel/accel.h"
#include "base/mem.h"
#include "check.h"
#include "math/hash.h"
#include "math/warp.h"
#include "scene_text.h"

static vec3 random_point(struct rng *r, float size) {
    return size * v3(2 * rng_float(r) - 1, 2 * rng_float(r) - 1, 2 * rng_float(r) - 1);
}

static void random_rays(struct rng *rng, struct ray rays[ACCEL_PACKET]) {
    for (int i = 0; i < ACCEL_PACKET; i++)
        rays[i] = (struct ray){random_point(rng, 3), random_point(rng, 1), 0,
                               i % 2 ? INFINITY : 4 * rng_float(rng)};
}

// Rays through edges may differ, and where surfaces cross.
static void hits_are_those_of_the_tree(const struct accel *a) {
    struct rng rng = {1};
    int found = 0, different = 0, blocked_differs = 0;
    for (int k = 0; k < 20000; k++) {
        struct ray rays[ACCEL_PACKET];
        struct accel_hit hits[ACCEL_PACKET], hit;
        const uint32_t active = k % 3 ? 0xffff : rng_u32(&rng) & 0xffff;
        random_rays(&rng, rays);
        accel_intersect16(a, rays, active, false, hits);
        const uint32_t blocked = accel_occluded16(a, rays, active, false);
        CHECK((blocked & ~active) == 0);
        for (int i = 0; i < ACCEL_PACKET; i++) {
            if (!(active >> i & 1))
                continue;
            const bool hits_one = accel_intersect(a, &rays[i], &hit);
            found += hits_one;
            blocked_differs += (blocked >> i & 1) != hits_one;
            if (hits_one != (hits[i].shape != SCENE_NONE))
                different++;
            else if (hits_one)
                different += hits[i].shape != hit.shape || hits[i].primitive != hit.primitive ||
                             hits[i].instance != SCENE_NONE ||
                             fabsf(hits[i].t - hit.t) > 1e-4f * hit.t ||
                             fabsf(hits[i].u - hit.u) > 1e-3f || fabsf(hits[i].v - hit.v) > 1e-3f;
        }
    }
    printf("%d hits, %d differ, %d blocked differ\n", found, different, blocked_differs);
    CHECK(found > 50000 && different < 30 && blocked_differs < 30);
}

// Towards corners, edges and face diagonals of the cube, and everywhere else.
static void nothing_leaves_a_closed_box(const struct accel *a, float size) {
    struct rng rng = {2};
    int lost = 0;
    for (int k = 0; k < 20000; k++) {
        struct ray rays[ACCEL_PACKET];
        struct accel_hit hits[ACCEL_PACKET];
        for (int i = 0; i < ACCEL_PACKET; i++) {
            const vec3 o = k % 2 ? random_point(&rng, 0.9f * size) : v3(0, 0, 0);
            vec3 target = random_point(&rng, 1);
            const int axis = (int)(rng_u32(&rng) % 3), kind = i % 4;
            target[axis] = 1;
            if (kind >= 1) // an edge
                target[(axis + 1) % 3] = -1;
            if (kind == 2) // a corner
                target[(axis + 2) % 3] = 1;
            if (kind == 3) // a diagonal
                target[(axis + 1) % 3] = target[(axis + 2) % 3] = 2 * rng_float(&rng) - 1;
            rays[i] = (struct ray){o, size * target - o, 0, INFINITY};
        }
        accel_intersect16(a, rays, 0xffff, false, hits);
        const uint32_t blocked = accel_occluded16(a, rays, 0xffff, false);
        for (int i = 0; i < ACCEL_PACKET; i++)
            lost += hits[i].shape == SCENE_NONE || !(blocked >> i & 1);
    }
    printf("size %g: %d of %d rays lost\n", (double)size, lost, 20000 * ACCEL_PACKET);
    CHECK(lost == 0);
}

static struct accel *accel_of(const char *body, struct scene **scene) {
    *scene = scene_parse(body);
    struct accel *a = *scene ? accel_create(*scene, 1) : NULL;
    if (!a)
        exit(1);
    CHECK(accel_mixes_packets(a));
    return a;
}

// Triangles alone in front of others that share a test: a tetrahedron in a cube.
static void triangles_in_front_of_quadrilaterals(void) {
    struct scene *s;
    scene_write("tetrahedron.obj", "v 0 0 0.9\nv 0.8 0 -0.5\nv -0.5 0.7 -0.4\nv -0.4 -0.7 -0.5\n"
                                   "f 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n");
    struct accel *a = accel_of(
        "<shape type='cube'><transform name='to_world'><scale value='2.5'/></transform></shape>"
        "<shape type='obj'><string name='filename' value='tetrahedron.obj'/>"
        "<transform name='to_world'><scale value='2'/></transform></shape>", &s);
    hits_are_those_of_the_tree(a);
    accel_destroy(a);
    scene_destroy(s);
}

int main(void) {
    struct scene *s;
    scene_folder_open();
    accel_thread_init();
    triangles_in_front_of_quadrilaterals();
    struct accel *a = accel_of(
        "<shape type='cube'><transform name='to_world'><rotate x='1' y='0.3' angle='40'/>"
        "<translate x='1'/></transform></shape>"
        "<shape type='rectangle'><transform name='to_world'><scale value='2'/>"
        "<rotate y='1' angle='70'/></transform></shape>"
        "<shape type='sphere'><float name='radius' value='0.7'/><point name='center' x='-1' y='1'"
        " z='0'/></shape>"
        "<shape type='sphere'><transform name='to_world'><scale x='0.3' y='1' z='0.5'/>"
        "<rotate x='1' y='1' angle='30'/><translate y='-1.5'/></transform></shape>"
        "<shape type='disk'><transform name='to_world'><scale x='2'/><rotate x='1' angle='50'/>"
        "<translate z='-2'/></transform></shape>"
        "<shape type='cylinder'><transform name='to_world'><scale x='0.3' y='0.5' z='2'/>"
        "<rotate y='1' angle='50'/><translate x='1' y='2'/></transform></shape>", &s);
    hits_are_those_of_the_tree(a);
    accel_destroy(a);
    scene_destroy(s);
    for (int i = 0; i < 3; i++) {
        char body[128];
        const float size = i == 0 ? 1 : i == 1 ? 1000 : 0.0123f;
        snprintf(body, sizeof body, "<shape type='cube'><transform name='to_world'><scale value='%g'/>"
                 "</transform></shape>", (double)size);
        a = accel_of(body, &s);
        nothing_leaves_a_closed_box(a, size);
        accel_destroy(a);
        scene_destroy(s);
    }
    scene_folder_close();
    return check_result();
}
