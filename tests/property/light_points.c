// SPDX-License-Identifier: Apache-2.0
// Lights that shine from one point, against closed forms: irradiance at a distance, power against
// the flux by quadrature. And the bounds by which the light tree knows a light, against brute force:
// wherever a sample finds the light, the tree must have a probability of choosing it.
#include <stdlib.h>
#include <unistd.h>

#include "check.h"
#include "light/light.h"
#include "make_object.h"
#include "math/hash.h"
#include "math/warp.h"

static struct arena arena;
static const struct entry *made[64]; // what was tested
static int made_count;

static struct object *make_light(const char *name, const char *overrides,
                                 const struct shape *shape) {
    struct object *o = make_object(&arena, &lights, name, overrides, NULL);
    const struct light_scene scene = {.radius = 1, .shape = shape};
    if (!light_type_of(o)->prepare(o, &scene, &arena))
        exit(1);
    made[made_count++] = o->type;
    return o;
}

static void check_delta(void) {
    struct light_sample s;
    const struct vec2 u = {0.5f, 0.5f};
    struct object *o = make_light("point", "position=1,2,3 intensity=4", NULL);
    CHECK(light_type_of(o)->sample(o->data, v3(1, 2, 5), u, &s) && s.delta && s.pdf_sa == 1);
    CHECK_NEAR(s.emission[0], 1, 1e-6);
    CHECK_NEAR(s.wi[2], -1, 1e-6);
    CHECK_NEAR(light_type_of(o)->power(o->data), 16 * M_PI, 1e-4);
    CHECK(!light_type_of(o)->sample(o->data, v3(1, 2, 3), u, &s));
    const float distances[4] = {1e-6f, 1e-3f, 1e3f, 1e6f};
    o = make_light("point", "intensity=1e30", NULL);
    for (int i = 0; i < 4; i++) {
        CHECK(light_type_of(o)->sample(o->data, v3(0, 0, distances[i]), u, &s));
        CHECK(spectrum_is_finite(s.emission));
        CHECK_NEAR(s.emission[1] / fmin(1e30 / pow((double)distances[i], 2), 3.402823466e38), 1,
                   1e-5);
    }
    o = make_light("spot", "intensity=3 cutoff_angle=40 beam_width=20", NULL);
    const float angles[4] = {0, 19.9f, 30, 40.1f}, expected[4] = {3, 3, 1.5f, 0};
    for (int i = 0; i < 4; i++) {
        const float a = angles[i] * (PI / 180);
        const bool lit = light_type_of(o)->sample(o->data, v3(2 * sinf(a), 0, 2 * cosf(a)), u, &s);
        CHECK(lit == (expected[i] > 0));
        if (lit)
            CHECK_NEAR(s.emission[0], expected[i] / 4, 1e-4);
    }
    o = make_light("directional", "direction=0,0,-2 irradiance=5", NULL);
    CHECK(light_type_of(o)->sample(o->data, v3(7, 8, 9), u, &s) && s.delta);
    CHECK(s.wi[2] == 1 && isinf(s.distance) && s.emission[2] == 5);
    CHECK_NEAR(light_type_of(o)->power(o->data), 5 * M_PI, 1e-4);
}

// ---- lights at a point: flux by quadrature over directions, and the light tree's bounds

static char profile_path[64] = "/tmp/relume-profile-XXXXXX.ies";

static void write_profile(void) {
    static const char text[] = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 4 3 1 2 0 0 0\n1 1 1\n"
                               "0 20 60 110\n0 90 180\n50 40 20 0\n50 60 10 0\n50 20 30 0\n";
    const int file = mkstemps(profile_path, 4);
    CHECK(file >= 0 && write(file, text, sizeof text - 1) == (ssize_t)sizeof text - 1);
    close(file);
}

static void check_flux(struct object *o) {
    enum { ROWS = 1500, COLUMNS = 90 };
    const struct vec2 u = {0.5f, 0.5f};
    double flux = 0;
    for (int y = 0; y < ROWS; y++)
        for (int x = 0; x < COLUMNS; x++) {
            struct light_sample s;
            const double theta = (y + 0.5) / ROWS * M_PI, phi = 2 * M_PI * (x + 0.5) / COLUMNS;
            const vec3 w = v3((float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)),
                              (float)cos(theta));
            if (!light_type_of(o)->sample(o->data, 3.0f * w, u, &s))
                continue;
            CHECK(s.delta && s.pdf_sa == 1);
            CHECK_NEAR(dot(s.wi, w), -1, 1e-5);
            flux += 9 * (double)spectrum_luminance(s.emission) * sin(theta);
        }
    flux *= M_PI / ROWS * 2 * M_PI / COLUMNS;
    printf("%s: power %.5g, by quadrature %.5g\n", o->type->name,
           (double)light_type_of(o)->power(o->data), flux);
    CHECK_NEAR(light_type_of(o)->power(o->data) / flux, 1, 5e-3);
}

// A tree must reach the light from wherever it lights.
static void check_bounds(struct object *o, float size) {
    struct light_bounds b[3];
    struct light_tree t;
    struct rng rng = {11};
    int lit = 0;
    for (int i = 0; i < 3; i++)
        b[i] = (struct light_bounds){.min = v3(5, 5, 5), .max = v3(6, 6, 6), .cos_o = -1,
                                     .axis = v3(0, 1, 0), .intensity = 1};
    light_type_of(o)->bounds(o->data, 0, &b[1]);
    CHECK(b[1].intensity > 0 && isfinite(b[1].intensity));
    light_tree_init(&t, b, 3);
    for (int i = 0; i < 200000; i++) {
        struct light_sample s;
        const struct vec2 u = {rng_float(&rng), rng_float(&rng)};
        const float x = rng_float(&rng), y = rng_float(&rng), z = rng_float(&rng);
        const struct light_place at = {
            size * (i % 4 ? 4.0f : 1.1f) * v3(2 * x - 1, 2 * y - 1, 2 * z - 1),
            warp_sphere((struct vec2){rng_float(&rng), rng_float(&rng)})};
        if (!light_type_of(o)->sample(o->data, at.p, u, &s))
            continue;
        lit++;
        CHECK(light_tree_pmf(&t, &at, 1) > 0);
        // the sample itself lies inside
        for (int k = 0; k < 3; k++)
            CHECK(s.p[k] >= b[1].min[k] - 1e-5f * size && s.p[k] <= b[1].max[k] + 1e-5f * size);
    }
    CHECK(lit > 20);
    light_tree_finish(&t);
}

static void check_area(const struct shape *shape) {
    struct object *o = make_light("area", "radiance=2", shape);
    check_bounds(o, 2);
    light_type_of(o)->finish(o->data);
}

// ---- lights of several parts

// A part's samples have the density that is said of them, and the parts together give what the whole
// gives: the mean of emission / pdf, 5 standard errors (false alarm 6e-7 each).
static void check_parts(void) {
    enum { SAMPLES = 40000, PLACES = 4 };
    const vec3 places[PLACES] = {v3(2, 1.5f, 3), v3(0, 1.2f, 0.3f), v3(-4, 0, 0), v3(30, 20, 10)};
    struct shape shape = {.name = "cube"};
    struct rng rng = {21};
    mesh_make_cube(&shape.mesh);
    struct object *o = make_light("area", "radiance=2", &shape);
    const struct light_type *type = light_type_of(o);
    const uint32_t parts = type->parts(o->data);
    CHECK(parts == shape.mesh.triangle_count);
    for (int k = 0; k < PLACES; k++) {
        double sum[2] = {0, 0}, sum2[2] = {0, 0};
        for (int i = 0; i < SAMPLES; i++) {
            const struct vec2 u = {rng_float(&rng), rng_float(&rng)};
            const uint32_t part = rng_u32(&rng) % parts;
            struct light_sample s[2] = {{.pdf_sa = 0}, {.pdf_sa = 0}};
            struct light_leaf leaf;
            type->part_shape(o->data, part, &leaf);
            const bool found[2] = {type->sample(o->data, places[k], u, &s[0]),
                                   type->part_sample(o->data, part, &leaf, places[k], u, &s[1])};
            for (int j = 0; j < 2; j++) {
                const double pdf = (double)s[j].pdf_sa / (j ? parts : 1);
                const double w = found[j] ? (double)spectrum_luminance(s[j].emission) / pdf : 0;
                sum[j] += w / SAMPLES;
                sum2[j] += w * w / SAMPLES;
            }
            const struct light_hit hit = {s[1].wi, s[1].distance, s[1].n, {.triangle = part}};
            if (found[1])
                CHECK_NEAR(type->part_pdf_sa(leaf.inv_area, &hit) / s[1].pdf_sa, 1, 1e-4);
        }
        const double variance = sum2[0] - sum[0] * sum[0] + sum2[1] - sum[1] * sum[1];
        CHECK_NEAR(sum[1], sum[0], 5 * sqrt(variance / SAMPLES));
    }
    type->finish(o->data);
    mesh_finish(&shape.mesh);
}

static void check_points(void) {
    char overrides[128];
    write_profile();
    snprintf(overrides, sizeof overrides, "unit=cd intensity=2 filename=%s", profile_path);
    struct object *o[] = {
        make_light("point", "intensity=4", NULL),
        make_light("spot", "intensity=3 cutoff_angle=40 beam_width=20", NULL),
        make_light("spot", "intensity=3 cutoff_angle=130 beam_width=0", NULL),
        make_light("projector", "irradiance=2 scale=3 fov=70", NULL),
        make_light("projector", "irradiance=2 fov=3", NULL),
        make_light("ies", overrides, NULL)};
    for (size_t i = 0; i < sizeof o / sizeof *o; i++) {
        if (i != 4) // too narrow for the quadrature
            check_flux(o[i]);
        check_bounds(o[i], 1);
    }
    struct light_sample s;
    const struct vec2 u = {0.5f, 0.5f};
    // a projector lights the plane z = 2 evenly: irradiance pi x 2 x 3 / 2^2
    for (int i = 0; i < 3; i++)
        if (light_type_of(o[3])->sample(o[3]->data, v3(0.5f * (float)i, -0.4f * (float)i, 2), u, &s))
            CHECK_NEAR(s.emission[0] * s.wi[2] / (-1.5 * M_PI), 1, 1e-5);
    // 40 cd at 20 degrees towards +x, 60 towards -y
    const float a = 20 * (PI / 180);
    CHECK(light_type_of(o[5])->sample(o[5]->data, v3(2 * sinf(a), 0, 2 * cosf(a)), u, &s));
    CHECK_NEAR(s.emission[1], 2 * 40.0 / 4, 1e-3);
    CHECK(light_type_of(o[5])->sample(o[5]->data, v3(0, -2 * sinf(a), 2 * cosf(a)), u, &s));
    CHECK_NEAR(s.emission[1], 2 * 60.0 / 4, 1e-3);
    light_type_of(o[5])->finish(o[5]->data);
    unlink(profile_path);
    struct shape rectangle = {.name = "rectangle"};
    mesh_make_rectangle(&rectangle.mesh);
    check_area(&rectangle);
    const struct transform place = transform_scale(0.5, 1.2, 0.7);
    for (int flip = 0; flip < 2; flip++)
        for (enum shape_kind kind = SHAPE_SPHERE; kind <= SHAPE_CYLINDER; kind++)
            check_area(&(struct shape){.kind = kind, .name = "quadric", .to_world = place,
                                       .flip_normals = flip});
    mesh_finish(&rectangle.mesh);
}

// Of the lights at a point and at infinity; the others are in light.c.
static void none_is_left_out(void) {
    for (const struct entry *const *e = lights.entries; *e; e++) {
        bool found = !((const struct light_type *)(const void *)*e)->delta;
        for (int i = 0; i < made_count; i++)
            found = found || made[i] == *e;
        CHECK(found);
    }
}

int main(void) {
    check_delta();
    check_points();
    check_parts();
    none_is_left_out();
    arena_finish(&arena);
    return check_result();
}
