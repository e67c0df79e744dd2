// SPDX-License-Identifier: Apache-2.0
// Every light of the registry that has a density, seen from points near, far, inside and behind
// (light_check.h), and extremes against a closed form. Lights at a point: light_points.c; with a
// texture: light_textured.c.
#include "property/light_check.h"

static struct object *make_light(const char *name, const char *overrides,
                                 const struct shape *shape) {
    struct object *o = make_object(&arena, &lights, name, overrides, NULL);
    const struct light_scene scene = {.radius = 1, .shape = shape};
    if (!light_type_of(o)->prepare(o, &scene, &arena))
        exit(1);
    return o;
}

static struct shape *new_mesh(const float (*positions)[3], uint32_t vertices,
                              const uint32_t (*indices)[3], uint32_t triangles) {
    struct shape *s = arena_alloc(&arena, sizeof *s);
    s->name = "test";
    s->mesh.vertex_count = vertices;
    s->mesh.triangle_count = triangles;
    s->mesh.positions = mem_array(vertices + 1, sizeof *s->mesh.positions);
    s->mesh.indices = mem_array(triangles, sizeof *s->mesh.indices);
    memcpy(s->mesh.positions, positions, vertices * sizeof *positions);
    memcpy(s->mesh.indices, indices, triangles * sizeof *indices);
    return keep_mesh(s);
}

static void add_rectangles(void) {
    struct shape *s = new_rectangle(false), *back = new_rectangle(true);
    struct object *light = make_light("area", "radiance=2", s);
    add_case("rectangle", CHART_TRIANGLES, light, s, v3(0.3f, 0.2f, 1));
    add_case("rectangle", CHART_TRIANGLES, light, s, v3(0.9f, -0.95f, 0.05f));
    add_case("rectangle", CHART_TRIANGLES, light, s, v3(3, 1, 0.5f));
    add_case("rectangle", CHART_TRIANGLES, light, s, v3(30, 10, 40));
    add_case("rectangle", CHART_TRIANGLES, light, s, v3(3e5f, 1e5f, 9e5f));
    add_case("rectangle", CHART_TRIANGLES, light, s, v3(0.1f, 0.2f, -1))->may_be_empty = true;
    add_case("rectangle", CHART_TRIANGLES, light, s, v3(0.1f, 0.2f, 0))->may_be_empty = true;
    light = make_light("area", "radiance=2", back);
    add_case("flipped rectangle", CHART_TRIANGLES, light, back, v3(0.1f, 0.2f, -0.5f));
}

static void add_triangles(void) {
    static const float v[5][3] = {{0, 0, 0}, {1, 0.1f, 0}, {0.2f, 0.7f, 0.3f}, {2, 2, 2},
                                  {0.5f, 0.05f, 0}};
    static const uint32_t one[1][3] = {{0, 1, 2}};
    // two of these have no area
    static const uint32_t several[4][3] = {{0, 1, 2}, {3, 3, 1}, {0, 4, 1}, {1, 3, 2}};
    struct shape *s = new_mesh(v, 3, one, 1), *m = new_mesh(v, 5, several, 4);
    struct object *light = make_light("area", "radiance=0.5,1,2", s);
    add_case("triangle", CHART_TRIANGLES, light, s, v3(0.3f, 0.2f, 0.5f));
    add_case("triangle", CHART_TRIANGLES, light, s, v3(0.4f, 0.3f, 0.17f));
    add_case("triangle", CHART_TRIANGLES, light, s, v3(0.3f, -2, 1.5f));
    add_case("triangle", CHART_TRIANGLES, light, s, v3(4, 3, 20));
    light = make_light("area", "radiance=0.5,1,2", m);
    add_case("mesh with degenerate triangles", CHART_TRIANGLES, light, m, v3(0.3f, 0.2f, 1.5f));
}

static void add_cube(void) {
    struct shape *s = arena_alloc(&arena, sizeof *s);
    s->name = "cube";
    mesh_make_cube(&s->mesh);
    keep_mesh(s);
    struct object *light = make_light("area", "radiance=1", s);
    add_case("cube", CHART_TRIANGLES, light, s, v3(2, 1.5f, 3));
}

static struct transform ellipsoid(void) {
    const double axis[3] = {1, 2, 3};
    const struct transform move = transform_translate(0.5, 1, -0.3),
                           turn = transform_rotate(axis, 40), scale = transform_scale(1, 0.4, 2);
    const struct transform a = transform_multiply(&turn, &scale);
    return transform_multiply(&move, &a);
}

static void add_quadrics(void) {
    const struct transform uniform = transform_scale(0.5, 0.5, 0.5), odd = ellipsoid();
    struct shape *s = new_quadric(SHAPE_SPHERE, &uniform, false);
    struct object *light = make_light("area", "radiance=1", s);
    add_case("sphere", CHART_SPHERE_CAP, light, s, v3(1, 0.3f, 0.2f));
    add_case("sphere", CHART_SPHERE_CAP, light, s, v3(0.7f, 0, 0));
    add_case("sphere", CHART_SPHERE_CAP, light, s, v3(0, 0, 1000));
    s = new_quadric(SHAPE_SPHERE, &uniform, true);
    light = make_light("area", "radiance=1", s);
    add_case("inside sphere", CHART_SPHERE_CAP, light, s, v3(0, 0, 0));
    add_case("inside sphere", CHART_SPHERE_CAP, light, s, v3(0.2f, 0.1f, -0.2f));
    s = new_quadric(SHAPE_SPHERE, &odd, false);
    light = make_light("area", "radiance=1", s);
    add_case("ellipsoid", CHART_QUADRIC, light, s, v3(3, 2, 1))->midpoints = 64;
    s = new_quadric(SHAPE_DISK, &odd, false);
    light = make_light("area", "radiance=1", s);
    const vec3 n = normalize(cross(affine_from(&odd).x, affine_from(&odd).y));
    add_case("disk", CHART_QUADRIC, light, s, affine_from(&odd).o + 2 * n + v3(0.3f, 0, 0));
    s = new_quadric(SHAPE_CYLINDER, &odd, false);
    light = make_light("area", "radiance=1", s);
    add_case("cylinder", CHART_QUADRIC, light, s, v3(3, 2, 1))->midpoints = 64;
    s = new_quadric(SHAPE_CYLINDER, &odd, true);
    light = make_light("area", "radiance=1", s);
    add_case("inside cylinder", CHART_QUADRIC, light, s, affine_from(&odd).o);
}

// ---- skies

static char picture_path[64] = "/tmp/relume-envmap-XXXXXX.exr";

// A picture with a small sun, a black part and colours.
static void write_picture(int width, int height) {
    struct image im;
    struct rng rng = {5};
    image_init(&im, width, height, 3);
    for (int i = 0; i < width * height * 3; i++)
        im.pixels[i] = i / 3 % width < width / 4 ? 0 : rng_float(&rng);
    im.pixels[3 * (width + width / 2) + 1] = 300;
    im.pixels[4] = NAN;
    im.pixels[8] = -1;
    CHECK(image_write_exr(picture_path, &im, &(struct image_exr_options){0}));
    image_finish(&im);
}

static struct object *make_envmap(const struct transform *to_world) {
    char overrides[128];
    snprintf(overrides, sizeof overrides, "scale=2 filename=%s", picture_path);
    struct object *o = make_object(&arena, &lights, "envmap", overrides, NULL);
    const struct param *p = param_find(o->type, "to_world");
    *(struct transform *)((char *)o->data + p->offset) = *to_world;
    const struct light_scene scene = {.radius = 1};
    const unsigned warnings = log_warning_count();
    CHECK(light_type_of(o)->prepare(o, &scene, &arena));
    CHECK(log_warning_count() == warnings + 1); // NaN and the negative number
    return o;
}

static void add_envmap(int width, int height) {
    const double axis[3] = {0.3, 1, -0.5};
    const struct transform turn = transform_rotate(axis, 77);
    write_picture(width, height);
    struct light_case *c = add_case("envmap", CHART_SKY, make_envmap(&turn), NULL, v3(0, 0, 0));
    snprintf(c->name, sizeof c->name, "envmap %d x %d", width, height);
    c->to_world = turn;
    c->kx = width;
    c->ky = height - 1;
    c->phase = 0.5 / width;
    unlink(picture_path);
}

static void add_skies(void) {
    struct light_case *c = add_case("constant", CHART_SKY, make_light("constant", "", NULL), NULL,
                                    v3(0, 0, 0));
    c->to_world = transform_identity;
    const int file = mkstemps(picture_path, 4);
    CHECK(file >= 0);
    close(file);
    add_envmap(16, 9);
    add_envmap(7, 3);
    const char *const suns[4] = {"sun_direction=0.3,0.5,0.6", "sun_direction=1,0,0.01",
                                 "sun_direction=0,1,2 turbidity=8.5 albedo=0.9 sun_aperture=20",
                                 "sun_direction=0.3,0.5,0.6 model=preetham"};
    for (int i = 0; i < 4; i++) {
        c = add_case(suns[i], CHART_CONE_AND_SKY, make_light("sunsky", suns[i], NULL), NULL,
                     v3(0, 0, 0));
        const vec3 d[4] = {v3(0.3f, 0.5f, 0.6f), v3(1, 0, 0.01f), v3(0, 1, 2), v3(0.3f, 0.5f, 0.6f)};
        const double half = (i == 2 ? 10 : 0.2679) * (M_PI / 180);
        snprintf(c->name, sizeof c->name, "sunsky %s", suns[i]);
        c->sun = normalize(d[i]);
        c->cone_height = 2 * sin(half / 2) * sin(half / 2);
        c->charts = 2;
        c->kx = 64;
        c->ky = 48;
        c->midpoints = 12;
    }
}

// ---- extremes, against a closed form

// Irradiance of a 2 x 2 m rectangle d metres above its middle (Lambert), for radiance L.
static double rectangle_irradiance(double d) {
    const double a = 1 / sqrt(1 + d * d);
    return 4 * a * atan(a);
}

// The mean of L cos / pdf at several distances in units of the light, and at radiances 1e-30, 1e30.
static void check_extremes(void) {
    const double distance[6] = {1e-3, 1e-2, 1, 1e2, 1e4, 1e6};
    const char *const radiance[3] = {"radiance=1e-30", "radiance=1", "radiance=1e30"};
    for (int k = 0; k < 3; k++) {
        struct shape *s = new_rectangle(false);
        struct object *o = make_light("area", radiance[k], s);
        for (int i = 0; i < 6; i++) {
            struct rng rng = {(uint64_t)(9 * i + k)};
            double sum = 0, sum2 = 0;
            const int n = 20000;
            for (int j = 0; j < n; j++) {
                struct light_sample x;
                const struct vec2 u = {rng_float(&rng), rng_float(&rng)};
                if (!light_type_of(o)->sample(o->data, v3(0, 0, (float)distance[i]), u, &x))
                    continue;
                CHECK(x.pdf_sa > 0 && isfinite(x.pdf_sa));
                const double w = (double)x.emission[0] / (double)x.pdf_sa * -(double)x.wi[2] *
                                 pow(10, 30 - 30 * k) / rectangle_irradiance(distance[i]);
                sum += w / n;
                sum2 += w * w / n;
            }
            // 36 values, 5 standard errors: false alarm 2e-5 in all
            CHECK_NEAR(sum, 1, 5 * sqrt(fmax(sum2 - sum * sum, 0) / n) + 1e-4);
        }
    }
}

// Those at a point have no density; they are in light_points.c.
static void none_is_left_out(void) {
    for (const struct entry *const *e = lights.entries; *e; e++) {
        bool found = ((const struct light_type *)(const void *)*e)->delta;
        for (int i = 0; i < case_count; i++)
            found = found || cases[i].light->type == *e;
        CHECK(found);
    }
}

int main(void) {
    add_rectangles();
    add_triangles();
    add_cube();
    add_quadrics();
    add_skies();
    none_is_left_out();
    check_cases();
    check_extremes();
    finish_cases();
    return check_result();
}
