// SPDX-License-Identifier: Apache-2.0
// Window materials: the synthetic files of the shared data, whose scattering is known.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "make_object.h"
#include "math/hash.h"
#include "table/window.h"

static const struct object *load(struct arena *arena, const char *file) {
    char overrides[4200];
    snprintf(overrides, sizeof overrides, "filename=%s/brdf/window-bsdf-xml/%s",
             getenv("RELUME_SHARED_DATA"), file);
    return make_bsdf(arena, "window", overrides, NULL);
}

static vec3 direction(double degrees, double azimuth) {
    const double t = degrees * M_PI / 180, p = azimuth * M_PI / 180;
    return v3((float)(sin(t) * cos(p)), (float)(sin(t) * sin(p)), (float)cos(t));
}

// What 200 000 samples bring back, above and below the surface.
static void scattered(const struct object *o, vec3 wo, double albedo[2]) {
    enum { N = 200000 };
    struct rng rng = {4};
    struct closure_stack stack = {0};
    const struct bsdf_point point = {0};
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    albedo[0] = albedo[1] = 0;
    for (int i = 0; c && i < N; i++) {
        struct bsdf_sample s;
        const float u1 = rng_float(&rng), u = rng_float(&rng), v = rng_float(&rng);
        if (closure_sample(c, u1, (struct vec2){u, v}, &s))
            albedo[s.wi[2] < 0] += (double)s.weight[0] / N;
    }
}

static double eval_f(const struct object *o, vec3 wo, vec3 wi) {
    struct closure_stack stack = {0};
    const struct bsdf_point point = {0};
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    float pdf;
    return c ? (double)(closure_eval(c, wi, &pdf)[0] / fabsf(wi[2])) : 0;
}

// { 0.8 / pi } is a Lambertian surface of 0.8, on both sides or one.
static void constant_trees_are_lambertian(void) {
    static const struct {
        const char *file;
        double front[2], back[2]; // above, below for an eye above; for an eye below
    } cases[] = {{"simple_tensor_refl.xml", {0.8, 0}, {0, 0.8}},
                 {"simple_tensor_d2_refl.xml", {-1, 0}, {0, -1}},
                 {"simple_tensor_trans.xml", {0, -1}, {-1, 0}}};
    for (int i = 0; i < 3; i++) {
        struct arena arena = {0};
        const struct object *o = load(&arena, cases[i].file);
        for (int a = 0; a < 90; a += 20)
            for (int below = 0; below < 2; below++) {
                double albedo[2];
                const vec3 wo = direction(below ? 179 - a : a + 1, 40);
                scattered(o, wo, albedo);
                const double *want = below ? cases[i].back : cases[i].front;
                if (a == 20)
                    printf("%s from %s: %.4f above, %.4f below\n", cases[i].file,
                           below ? "below" : "above", albedo[0], albedo[1]);
                for (int k = 0; k < 2; k++)
                    if (want[k] >= 0)
                        CHECK_NEAR(albedo[k], want[k], 0.01);
                    else
                        CHECK(albedo[k] <= 1.01);
            }
        arena_finish(&arena);
    }
}

// One value of the full Klems basis: light that arrives in the first patch of 5 degrees leaves
// through it. 42 pi sin^2 5 degrees.
static void a_matrix_lets_light_through(void) {
    struct arena arena = {0};
    const struct object *o = load(&arena, "simple_klems_spot_trans.xml");
    double albedo[2];
    scattered(o, direction(179, 10), albedo); // WINDOW's front is outdoors: below
    printf("klems spot from below: %.4f above, %.4f below\n", albedo[0], albedo[1]);
    CHECK_NEAR(albedo[0], 42 * M_PI * pow(sin(5 * M_PI / 180), 2), 0.005);
    CHECK_NEAR(albedo[1], 0, 1e-6);
    CHECK_NEAR(eval_f(o, direction(178, 10), direction(3, 70)), 42, 1e-3);
    CHECK_NEAR(eval_f(o, direction(178, 10), direction(7, 70)), 0, 1e-6);
    CHECK_NEAR(eval_f(o, direction(3, 70), direction(178, 10)), 42, 1e-3); // reciprocity
    arena_finish(&arena);
}

// Sampling agrees with quadrature of eval for every file.
static void samples_agree_with_values(void) {
    static const char *const files[] = {"simple_tensor_spot_refl.xml", "simple_tensor_d3_refl.xml",
                                        "simple_tensor_d3_t3_refl.xml",
                                        "simple_tensor_d2_t3_trans.xml",
                                        "simple_tensor_d2_line_refl.xml",
                                        "simple_tensor_spot_t3_trans.xml"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        struct arena arena = {0};
        const struct object *o = load(&arena, files[i]);
        for (int a = 0; a < 4; a++) {
            enum { N = 400 };
            const vec3 wo = direction(a < 2 ? 20 + 40 * a : 200 - 40 * a, 30 + 70 * a);
            double albedo[2], sum[2] = {0};
            scattered(o, wo, albedo);
            for (int k = 0; k < 2 * N * N; k++) { // uniform in projected solid angle
                const double z2 = (k / 2 / N + 0.5) / N, r = sqrt(1 - z2);
                const double phi = 2 * M_PI * (k / 2 % N + 0.5) / N;
                const vec3 wi = v3((float)(r * cos(phi)), (float)(r * sin(phi)),
                                   (float)(k % 2 ? -sqrt(z2) : sqrt(z2)));
                sum[k % 2] += eval_f(o, wo, wi) * M_PI / N / N;
            }
            for (int k = 0; k < 2; k++)
                CHECK_NEAR(albedo[k], sum[k], 0.01 * fmax(sum[k], 0.05));
            CHECK(albedo[0] + albedo[1] >= 0);
        }
        arena_finish(&arena);
    }
}

static void patches_are_consistent(void) {
    struct window_cells klems = {.rings = 2, .count = 5, .theta = {0, 30, 90}, .sectors = {1, 4}};
    const struct window_cells squares = {.side = 8, .count = 64};
    struct rng rng = {2};
    for (int kind = 0; kind < 2; kind++) {
        const struct window_cells *c = kind ? &squares : &klems;
        double total = 0;
        for (int cell = 0; cell < c->count; cell++) {
            total += window_cell_psa(c, cell);
            for (int i = 0; i < 1000; i++) {
                const float u = 0.001f + 0.998f * rng_float(&rng);
                const float v = 0.001f + 0.998f * rng_float(&rng);
                const vec3 w = window_cell_sample(c, cell, (struct vec2){u, v});
                CHECK(window_cell_of(c, w) == cell);
            }
        }
        CHECK_NEAR(total, M_PI, 1e-6);
    }
}

int main(void) {
    patches_are_consistent();
    if (getenv("RELUME_SHARED_DATA")) {
        constant_trees_are_lambertian();
        a_matrix_lets_light_through();
        samples_agree_with_values();
    }
    return check_result();
}
