// SPDX-License-Identifier: Apache-2.0
// Every light of the registry, seen from points near, far, inside and behind:
//
//  - samples against pdf_sa: chi-square over charts of the light, refused samples as a bin of their
//    own, expected counts by quadrature. All of them together raise a false alarm with
//    probability 1 % (Sidak), once per choice of seeds;
//  - a sample's density and emission equal pdf_sa and emission of the hit at the same place;
//  - the mean of emission / pdf equals the integral of the emission (z-test, counted above);
//  - the power of infinite lights equals the integral to 10 %;
//  - extremes against a closed form. (Lights at a point: light_points.c.)
#include <stdlib.h>
#include <unistd.h>

#include "check.h"
#include "image/image.h"
#include "math/hash.h"
#include "property/light_cases.h"
#include "statistics.h"

enum { SAMPLES = 200000, MOST_BINS = 8192, CASES = 64 };

static const double FALSE_ALARMS = 0.01;
static struct arena arena;
static struct light_case cases[CASES];
static int case_count;
static double tested[2 * CASES];
static char tested_name[2 * CASES][112];
static int tested_count;

static void add_p_value(const struct light_case *c, const char *what, double p) {
    snprintf(tested_name[tested_count], sizeof tested_name[0], "%s: %s", c->name, what);
    tested[tested_count++] = p;
}

// ---- the engine

struct pair {
    double a, b;
};

struct chart_ctx {
    const struct light_case *c;
    int chart;
    double unit; // of the emission
};

// Density and luminance of the emission, per unit of the chart.
static struct pair chart_density(const struct chart_ctx *x, double s, double t) {
    struct light_hit hit;
    double solid_angle;
    if (!chart_hit(x->c, x->chart, s, t, &hit, &solid_angle))
        return (struct pair){0, 0};
    const float pdf = case_type(x->c)->pdf_sa(x->c->light->data, x->c->p, &hit);
    const spectrum e = case_type(x->c)->emission(x->c->light->data, &hit);
    CHECK(pdf >= 0 && isfinite(pdf) && spectrum_is_finite(e) && spectrum_min(e) >= 0);
    return (struct pair){(double)pdf * solid_angle, (double)spectrum_luminance(e) * solid_angle / x->unit};
}

// Gauss-Legendre, 4 x 4 points in each of PANELS x PANELS parts of the bin, or midpoints.
static struct pair bin_integral(const struct light_case *c, int chart, int x, int y,
                                double unit) {
    enum { PANELS = 4 };
    static const double node[4] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281,
                                   0.9305681557970263};
    static const double weight[4] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                     0.1739274225687269};
    struct chart_ctx ctx = {c, chart, unit};
    const int n = c->midpoints ? c->midpoints : 4 * PANELS;
    struct pair sum = {0, 0};
    for (int i = 0; i < n * n; i++) {
        const int a = i % n, b = i / n;
        const double s = c->midpoints ? (a + 0.5) / n : (a / 4 + node[a % 4]) / PANELS;
        const double t = c->midpoints ? (b + 0.5) / n : (b / 4 + node[b % 4]) / PANELS;
        const double w = c->midpoints ? 1.0 / (n * n)
                                      : weight[a % 4] * weight[b % 4] / (PANELS * PANELS);
        const struct pair v = chart_density(&ctx, (x + s) / c->kx, (y + t) / c->ky);
        sum.a += w * v.a / (c->kx * c->ky);
        sum.b += w * v.b / (c->kx * c->ky);
    }
    return sum;
}

struct tally {
    int observed[MOST_BINS];
    int refused;
    double sum, sum2;
    float worst_pdf, worst_emission; // relative differences
};

static float difference(float a, float b) {
    return fabsf(a - b) / fmaxf(fmaxf(a, b), 1e-30f);
}

static void check_sample(const struct light_case *c, const struct light_sample *x, int chart,
                         double s, double t, struct tally *out) {
    struct light_hit hit;
    double solid_angle;
    if (s < 1e-4 || s > 1 - 1e-4 || t < 1e-4 || t > 1 - 1e-4 ||
        !chart_hit(c, chart, s, t, &hit, &solid_angle))
        return; // charts end here, and their derivatives
    if (c->shape && dot(hit.wi, hit.ng) > -0.02f)
        return; // the cosine has lost its digits
    const float pdf = case_type(c)->pdf_sa(c->light->data, c->p, &hit);
    const spectrum e = case_type(c)->emission(c->light->data, &hit);
    out->worst_pdf = fmaxf(out->worst_pdf, difference(pdf, x->pdf_sa));
    out->worst_emission = fmaxf(out->worst_emission, difference(spectrum_luminance(e),
                                                                spectrum_luminance(x->emission)));
}

static void draw(const struct light_case *c, struct tally *out) {
    struct rng rng = {hash_u64((uint64_t)(c - cases) + 77)};
    for (int i = 0; i < SAMPLES; i++) {
        struct light_sample x;
        const struct vec2 u = {rng_float(&rng), rng_float(&rng)};
        if (!case_type(c)->sample(c->light->data, c->p, u, &x)) {
            out->refused++;
            continue;
        }
        CHECK(x.pdf_sa > 0 && isfinite(x.pdf_sa) && !x.delta && x.distance > 0);
        CHECK(spectrum_is_finite(x.emission) && spectrum_min(x.emission) >= 0);
        CHECK_NEAR(length(x.wi), 1, 1e-5);
        const double weight = (double)spectrum_luminance(x.emission) / (double)x.pdf_sa;
        out->sum += weight;
        out->sum2 += weight * weight;
        double s = 0, t = 0;
        const int chart = chart_of(c, &x, &s, &t);
        CHECK(chart >= 0);
        const int bx = (int)fmin(fmax(s, 0) * c->kx, c->kx - 1);
        const int by = (int)fmin(fmax(t, 0) * c->ky, c->ky - 1);
        out->observed[(chart * c->ky + by) * c->kx + bx]++;
        if (i % 16 == 0)
            check_sample(c, &x, chart, s, t, out);
    }
}

static void check_case(const struct light_case *c) {
    static struct tally tally;
    tally = (struct tally){0};
    draw(c, &tally);
    struct chi2_bins bins = {0};
    struct pair total = {0, 0};
    const double mean = tally.sum / SAMPLES;
    for (int i = 0; i < c->charts * c->kx * c->ky; i++) {
        const int chart = i / (c->kx * c->ky);
        const struct pair v = bin_integral(c, chart, i % c->kx, i / c->kx % c->ky, fmax(mean, 1e-300));
        chi2_add(&bins, tally.observed[i], v.a * SAMPLES);
        total.a += v.a;
        total.b += v.b;
    }
    CHECK(total.a <= 1.001);
    chi2_add(&bins, tally.refused, fmax(1 - total.a, 0) * SAMPLES);
    const double integral = total.b * mean;
    const double variance = fmax(tally.sum2 / SAMPLES - mean * mean, 0) / SAMPLES;
    const double error = sqrt(variance) + 2e-5 * mean; // float, and the quadrature
    const double z = (mean - integral) / fmax(error, 1e-300);
    printf("%-44s pdf integral %.5f  emission %.5g (+- %.2g), by quadrature %.5g  pdf differs %.1e\n",
           c->name, total.a, mean, sqrt(variance), integral, (double)tally.worst_pdf);
    CHECK(c->may_be_empty || total.a > 0.2);
    CHECK(tally.worst_pdf < 2e-3f && tally.worst_emission < 2e-3f);
    add_p_value(c, "chi-square", chi2_finish(&bins));
    add_p_value(c, "mean", c->may_be_empty && mean == 0 ? 1 : normal_p_value(z));
    if (case_type(c)->infinite) {
        const double power = 4 * M_PI * M_PI * integral / (4 * M_PI); // scene radius 1
        CHECK_NEAR(case_type(c)->power(c->light->data) / power, 1, 0.1);
    }
}

// ---- cases

static struct light_case *add_case(const char *name, enum chart_kind kind, struct object *light,
                                   const struct shape *shape, vec3 p) {
    struct light_case *c = &cases[case_count++];
    *c = (struct light_case){.kind = kind, .light = light, .shape = shape, .p = p, .charts = 1,
                             .kx = 16, .ky = 16};
    snprintf(c->name, sizeof c->name, "%s from %g %g %g", name, (double)p[0], (double)p[1],
             (double)p[2]);
    if (shape && shape->kind == SHAPE_MESH) {
        c->charts = (int)shape->mesh.triangle_count;
        c->kx = c->ky = 8;
    }
    return c;
}

static struct object *make_light(const char *name, const char *overrides,
                                 const struct shape *shape) {
    struct object *o = make_object(&arena, &lights, name, overrides, NULL);
    const struct light_scene scene = {.radius = 1, .shape = shape};
    if (!light_type_of(o)->prepare(o, &scene, &arena))
        exit(1);
    return o;
}

static struct shape *meshes[16];
static int mesh_count;

static struct shape *keep_mesh(struct shape *s) {
    meshes[mesh_count++] = s;
    return s;
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

static struct shape *new_quadric(enum shape_kind kind, const struct transform *to_world,
                                 bool flip) {
    struct shape *s = arena_alloc(&arena, sizeof *s);
    *s = (struct shape){.kind = kind, .name = "test", .to_world = *to_world,
                        .flip_normals = flip};
    return s;
}

static struct shape *new_rectangle(bool flip) {
    struct shape *s = arena_alloc(&arena, sizeof *s);
    s->name = "rectangle";
    s->flip_normals = flip;
    mesh_make_rectangle(&s->mesh);
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

// A picture that is mostly dark, on a rectangle: near, far, and seen from behind.
static void add_textured(void) {
    struct shape *s = new_rectangle(false);
    struct object *texture = make_texture(&arena, "checkerboard", "color0=0.05 color1=3", NULL);
    const struct object *const children[] = {texture, NULL};
    struct object *light = make_object(&arena, &lights, "area", "", children);
    const struct light_scene scene = {.radius = 1, .shape = s};
    CHECK(light_type_of(light)->prepare(light, &scene, &arena));
    const vec3 from[4] = {v3(0.3f, 0.2f, 0.4f), v3(-0.9f, 0.5f, 0.02f), v3(3, 1, 5), v3(0, 0, 300)};
    for (int i = 0; i < 4; i++) {
        struct light_case *c = add_case("textured rectangle", CHART_TRIANGLES, light, s, from[i]);
        c->kx = c->ky = 16;
        c->midpoints = 96;
    }
    add_case("textured rectangle", CHART_TRIANGLES, light, s, v3(0, 0, -1))->may_be_empty = true;
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

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(void) {
    add_rectangles();
    add_triangles();
    add_textured();
    add_cube();
    add_quadrics();
    add_skies();
    for (int i = 0; i < case_count; i++)
        check_case(&cases[i]);
    const double least = sidak(FALSE_ALARMS, tested_count);
    for (int i = 0; i < tested_count; i++) {
        if (tested[i] < least)
            printf("%s: p = %.3g, expected at least %.3g\n", tested_name[i], tested[i], least);
        CHECK(tested[i] >= least);
    }
    qsort(tested, (size_t)tested_count, sizeof tested[0], by_value);
    printf("%d tests, smallest p %.3g, median %.3g, threshold %.3g\n", tested_count, tested[0],
           tested[tested_count / 2], least);
    check_extremes();
    for (int i = 0; i < case_count; i++)
        if (case_type(&cases[i])->finish && (i == 0 || cases[i].light != cases[i - 1].light))
            case_type(&cases[i])->finish(cases[i].light->data);
    for (int i = 0; i < mesh_count; i++)
        mesh_finish(&meshes[i]->mesh);
    arena_finish(&arena);
    return check_result();
}
