// SPDX-License-Identifier: Apache-2.0
// Rays of the sensors against closed forms: corners and middle for every field-of-view axis, the
// handedness of look-at, clip distances, recentring far from the origin, where a thin lens focuses.
#include <string.h>

#include "check.h"
#include "make_object.h"
#include "math/hash.h"
#include "sensor/sensor.h"

enum { WIDTH = 640, HEIGHT = 360 };

static struct arena arena;
static const double origin[3] = {0, 0, 0};

static struct object *make_sensor(const char *name, const char *overrides,
                                  const struct transform *to_world) {
    struct object *o = make_object(&arena, &sensors, name, overrides, NULL);
    if (to_world)
        *(struct transform *)((char *)o->data + param_find(o->type, "to_world")->offset) =
            *to_world;
    return o;
}

static struct ray shoot(const struct object *o, float x, float y, struct vec2 u) {
    struct ray r;
    sensor_type_of(o)->ray(o->data, x, y, u, &r);
    CHECK_NEAR(length(r.d), 1, 1e-6);
    CHECK(r.tmin >= 0 && r.tmin < r.tmax);
    return r;
}

static bool prepare(struct object *o) {
    return sensor_type_of(o)->prepare(o, &(struct sensor_scene){.width = WIDTH, .height = HEIGHT});
}

// The tangent of half the horizontal field of view that a camera really has, from its corner rays.
static double half_width(const char *overrides) {
    struct object *o = make_sensor("perspective", overrides, NULL);
    CHECK(prepare(o));
    const struct vec2 u = {0.5f, 0.5f};
    const struct ray left = shoot(o, 0, HEIGHT / 2, u), corner = shoot(o, WIDTH, HEIGHT, u);
    CHECK_NEAR(left.d[1], 0, 1e-6);
    const double tangent = (double)left.d[0] / (double)left.d[2];
    CHECK_NEAR(corner.d[0] / corner.d[2], -tangent, 1e-6 * (1 + tangent));
    CHECK_NEAR(corner.d[1] / corner.d[2], -tangent * HEIGHT / WIDTH, 1e-6 * (1 + tangent));
    return tangent;
}

static void check_fields_of_view(void) {
    const double t = tan(20 * (M_PI / 180)), aspect = (double)WIDTH / HEIGHT;
    const double diagonal = t / sqrt(1 + 1 / (aspect * aspect));
    const double film = 0.5 * sqrt(36 * 36 + 24 * 24) / sqrt(1 + 1 / (aspect * aspect));
    CHECK_NEAR(half_width("fov=40"), t, 1e-6);
    CHECK_NEAR(half_width("fov=40 fov_axis=x"), t, 1e-6);
    CHECK_NEAR(half_width("fov=40 fov_axis=y"), t * aspect, 1e-6);
    CHECK_NEAR(half_width("fov=40 fov_axis=smaller"), t * aspect, 1e-6);
    CHECK_NEAR(half_width("fov=40 fov_axis=larger"), t, 1e-6);
    CHECK_NEAR(half_width("fov=40 fov_axis=diagonal"), diagonal, 1e-6);
    CHECK_NEAR(half_width(""), film / 50, 1e-6);
    CHECK_NEAR(half_width("focal_length=35mm"), film / 35, 1e-6);
    CHECK_NEAR(half_width("focal_length=85"), film / 85, 1e-6);
}

static void check_refusals(void) {
    static const char *const bad[] = {"fov=40 focal_length=35mm", "focal_length=wide",
                                      "near_clip=2 far_clip=1"};
    log_set_level(LOG_ERROR);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(!prepare(make_sensor("perspective", bad[i], NULL)));
    const struct transform flat = transform_scale(1, 0, 1);
    CHECK(!prepare(make_sensor("orthographic", "", &flat)));
    static const char *const all[][2] = {
        {"perspective", ""}, {"orthographic", ""}, {"thinlens", "aperture_radius=1"}};
    const struct transform far = transform_translate(0, 0, -1e17), beyond = transform_translate(0, 2e18, 0);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        CHECK(prepare(make_sensor(all[i][0], all[i][1], &far)));
        CHECK(!prepare(make_sensor(all[i][0], all[i][1], &beyond)));
    }
    log_set_level(LOG_INFO);
}

// A camera on +z that looks at the origin with y up sees +x at the right and +y at the top.
static void check_handedness(void) {
    const double eye[3] = {0, 0, 5}, up[3] = {0, 1, 0};
    struct transform look;
    CHECK(transform_look_at(eye, origin, up, &look));
    const char *const names[3] = {"perspective", "orthographic", "thinlens"};
    const char *const overrides[3] = {"fov=40", "", "fov=40 aperture_radius=0"};
    for (int i = 0; i < 3; i++) {
        struct object *o = make_sensor(names[i], overrides[i], &look);
        CHECK(prepare(o));
        const struct ray r = shoot(o, 0.75f * WIDTH, 0.25f * HEIGHT, (struct vec2){0.3f, 0.6f});
        const vec3 p = r.o + r.d * ((0 - r.o[2]) / r.d[2]);
        CHECK(p[0] > 0.1f && p[1] > 0.1f && r.d[2] < 0);
    }
}

static void check_clipping(void) {
    struct object *o = make_sensor("perspective", "fov=90 near_clip=0.5 far_clip=20", NULL);
    CHECK(prepare(o));
    const struct ray r = shoot(o, 10, 20, (struct vec2){0, 0});
    CHECK_NEAR((r.o + r.tmin * r.d)[2], 0.5, 1e-6);
    CHECK_NEAR((r.o + r.tmax * r.d)[2], 20, 1e-5);
    o = make_sensor("orthographic", "near_clip=0.5 far_clip=20", NULL);
    CHECK(prepare(o));
    const struct ray s = shoot(o, 0, 0, (struct vec2){0, 0});
    CHECK_NEAR(s.o[0], 1, 1e-6);
    CHECK_NEAR(s.o[1], (double)HEIGHT / WIDTH, 1e-6);
    CHECK_NEAR((s.o + s.tmin * s.d)[2], 0.5, 1e-6);
    CHECK_NEAR((s.o + s.tmax * s.d)[2], 20, 1e-5);
    o = make_sensor("perspective", "fov=90 principal_point_offset_x=0.1 "
                                   "principal_point_offset_y=-0.2", NULL);
    CHECK(prepare(o));
    const struct ray t = shoot(o, 0.4f * WIDTH, 0.7f * HEIGHT, (struct vec2){0, 0});
    CHECK_NEAR(t.d[2], 1, 1e-6); // the optical axis
}

// Far away, what is subtracted in double leaves no error.
static void check_recentring(void) {
    const struct transform far = transform_translate(1e6 + 0.125, -3e6, 7e6 + 0.5);
    struct object *o = make_sensor("perspective", "fov=40", &far);
    const struct sensor_scene scene = {WIDTH, HEIGHT, {1e6, -3e6, 7e6}, NULL, NULL};
    CHECK(sensor_type_of(o)->prepare(o, &scene));
    const struct ray r = shoot(o, 1, 2, (struct vec2){0, 0});
    CHECK(r.o[0] == 0.125f && r.o[1] == 0 && r.o[2] == 0.5f);
}

// All rays of a film point meet at the focus distance, and start on the lens.
static void check_lens(void) {
    const double eye[3] = {1, 2, 3}, target[3] = {4, 1, -2}, up[3] = {0, 1, 0.2};
    struct transform look, inverse;
    CHECK(transform_look_at(eye, target, up, &look) && transform_invert(&look, &inverse));
    struct object *o =
        make_sensor("thinlens", "fov=50 aperture_radius=0.3 focus_distance=4", &look);
    struct object *pinhole = make_sensor("perspective", "fov=50", &look);
    CHECK(prepare(o) && prepare(pinhole));
    struct rng rng = {3};
    double farthest = 0;
    for (int i = 0; i < 1000; i++) {
        const float x = rng_float(&rng) * WIDTH, y = rng_float(&rng) * HEIGHT;
        const struct vec2 u = {rng_float(&rng), rng_float(&rng)};
        const struct ray r = shoot(o, x, y, u), q = shoot(pinhole, x, y, u);
        const vec3 axis = affine_from(&look).z;
        const vec3 a = r.o + r.d * (dot(q.o + 4 * axis - r.o, axis) / dot(r.d, axis));
        const vec3 b = q.o + q.d * (4 / dot(q.d, axis));
        CHECK_NEAR(length(a - b), 0, 1e-5);
        CHECK_NEAR(dot(r.o - q.o, axis), 0, 1e-6);
        farthest = fmax(farthest, (double)length(r.o - q.o));
    }
    CHECK(farthest <= 0.3 + 1e-6 && farthest > 0.28);
}

int main(void) {
    check_fields_of_view();
    check_refusals();
    check_handedness();
    check_clipping();
    check_recentring();
    check_lens();
    arena_finish(&arena);
    return check_result();
}
