// SPDX-License-Identifier: Apache-2.0
// Rays that are no numbers, or that begin beyond all scenes, meet nothing, alone, in packets and in
// streams, and leave the others beside them as they are.
#include "accel/accel.h"
#include "check.h"
#include "scene_text.h"

static const vec3 good_o = {0.1f, 0.2f, 5}, good_d = {0, 0, -1};

static int make_rays(struct ray rays[ACCEL_PACKET]) {
    const float bad[] = {NAN, INFINITY, -INFINITY, 1e19f, -3e38f};
    int n = 0;
    for (int i = 0; i < 5; i++)
        for (int where = 0; where < 2; where++) {
            rays[n] = (struct ray){good_o, good_d, 0, INFINITY};
            (where ? &rays[n].d : &rays[n].o)[0][i % 3] = bad[i];
            n++;
        }
    rays[n++] = (struct ray){good_o, good_d, NAN, INFINITY};
    rays[n++] = (struct ray){good_o, good_d, 0, NAN};
    // Embree without assertions lets this one meet what lies behind it.
    rays[n++] = (struct ray){-good_o, good_d, -100, INFINITY};
    return n;
}

static void check_rays(const struct accel *a) {
    struct ray rays[ACCEL_PACKET];
    struct accel_hit hits[ACCEL_PACKET], hit;
    bool blocked[ACCEL_PACKET];
    const int bad = make_rays(rays);
    for (int i = bad; i < ACCEL_PACKET; i++)
        rays[i] = (struct ray){good_o, good_d, 0, INFINITY};
    for (int coherent = 0; coherent < 2; coherent++) {
        accel_intersect16(a, rays, 0xffff, coherent, hits);
        CHECK(accel_occluded16(a, rays, 0xffff, coherent) == (0xffffu << bad & 0xffff));
        for (int i = 0; i < ACCEL_PACKET; i++)
            CHECK((hits[i].shape == SCENE_NONE) == (i < bad));
    }
    accel_occluded_each(a, rays, ACCEL_PACKET, blocked);
    for (int i = 0; i < ACCEL_PACKET; i++) {
        CHECK(blocked[i] == (i >= bad));
        CHECK(accel_intersect(a, &rays[i], &hit) == (i >= bad));
        CHECK((hit.shape == SCENE_NONE) == (i < bad));
        CHECK(accel_occluded(a, &rays[i]) == (i >= bad));
    }
}

int main(void) {
    scene_folder_open();
    struct scene *s = scene_parse("<shape type='shapegroup' id='g'><shape type='cube'/></shape>\n"
                                  "<shape type='instance'><ref id='g'/></shape>\n"
                                  "<shape type='cube'/>");
    struct accel *a = s ? accel_create(s, 1) : NULL;
    CHECK(a);
    if (a) {
        accel_thread_init();
        check_rays(a);
    }
    accel_destroy(a);
    scene_destroy(s);
    scene_folder_close();
    return check_result();
}
