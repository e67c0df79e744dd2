// SPDX-License-Identifier: Apache-2.0
// Indices of refraction from 1 to a thousand: at 1 nothing is there, near 1 almost nothing, at large
// ones Fresnel's formula holds, and what is given does not jump in between.
#include <stdio.h>

#include "check.h"
#include "property/bsdf_cases.h"

static const float heights[] = {1, 0.99999994f, 1.7453e-2f, 1.7453e-5f, 1e-7f, 1e-12f, 1e-30f};

enum { HEIGHTS = sizeof heights / sizeof *heights };

static vec3 direction(float z, float phi, float sign) {
    const float r = safe_sqrt((1 - z) * (1 + z));
    return v3(r * cosf(phi), r * sinf(phi), sign * z);
}

// ---- indices near 1 -------------------------------------------------------------------------

static void equal_indices_leave_nothing(void) {
    const char *const names[] = {"dielectric", "roughdielectric", "thindielectric"};
    const struct bsdf_point point = bsdf_case_point();
    for (int i = 0; i < 3; i++) {
        struct arena arena = {0};
        const struct object *o = make_bsdf(&arena, names[i], "int_ior=1.3 ext_ior=1.3", NULL);
        CHECK(bsdf_lobes(o) & LOBE_NULL);
        for (int k = 0; k < 2 * HEIGHTS; k++) {
            static struct closure_stack stack;
            struct bsdf_sample s;
            const vec3 wo = direction(heights[k / 2], 0.3f, k % 2 ? -1 : 1);
            stack.used = 0;
            const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
            CHECK(c && closure_sample(c, 0, (struct vec2){0, 0}, &s));
            CHECK(s.lobe == (LOBE_NULL | LOBE_TRANSMISSION) && s.eta == 1 && s.pdf_sa == 1);
            CHECK(s.wi[0] == -wo[0] && s.wi[1] == -wo[1] && s.wi[2] == -wo[2]);
            CHECK(spectrum_min(s.weight) == 1 && spectrum_max(s.weight) == 1);
            CHECK(spectrum_min(bsdf_null_transmittance(o, &point, wo)) == 1);
        }
        arena_finish(&arena);
    }
}

// As the index approaches 1, light comes to go straight through with weight 1.
static void nearly_equal_indices_leave_almost_nothing(void) {
    const char *const names[] = {"dielectric", "roughdielectric"};
    const struct bsdf_point point = bsdf_case_point();
    for (int i = 0; i < 2; i++) {
        for (int k = 2; k < 8; k++) {
            struct arena arena = {0};
            const double excess = pow(10, -k);
            const struct object *o = make_bsdf(
                &arena, names[i], arena_printf(&arena, "int_ior=%.9g ext_ior=1", 1 + excess), NULL);
            static struct closure_stack stack;
            struct bsdf_sample s;
            const vec3 wo = direction(0.7f, 0.3f, 1);
            stack.used = 0;
            const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
            for (int j = 0; j < 100; j++) {
                const struct vec2 u = {(float)j / 100, (float)(j * 7 % 100) / 100};
                CHECK(closure_sample(c, 0.5f, u, &s));
                CHECK(length(s.wi + wo) <= 3 * excess);
                CHECK_NEAR(spectrum_mean(s.weight), 1, 2.1 * excess + 1e-6);
            }
            arena_finish(&arena);
        }
    }
}

// ---- large indices --------------------------------------------------------------------------

// Reflectance of the facet at the normal, from the smooth material or a rough one of the same index.
static double reflectance_at_normal(const char *name, const char *overrides) {
    struct arena arena = {0};
    static struct closure_stack stack;
    const struct bsdf_point point = bsdf_case_point();
    struct bsdf_sample s;
    stack.used = 0;
    const struct object *o = make_bsdf(&arena, name, overrides, NULL);
    const struct closure *c = bsdf_resolve(o, &point, v3(0, 0, 1), &stack);
    const bool hit = c && closure_sample(c, 0, (struct vec2){0.5f, 0}, &s);
    CHECK(hit && s.lobe & LOBE_REFLECTION);
    const double value = hit ? (double)(spectrum_mean(s.weight) * s.pdf_sa) : 0;
    arena_finish(&arena);
    return value;
}

static void large_indices_follow_fresnel(void) {
    const double dielectric = 999.0 / 1001 * 999.0 / 1001, metal = 1e6 / (4 + 1e6);
    CHECK_NEAR(reflectance_at_normal("dielectric", "int_ior=1e3 ext_ior=1"), dielectric, 1e-6);
    CHECK_NEAR(reflectance_at_normal("thindielectric", "int_ior=1e3 ext_ior=1"),
               2 * dielectric / (1 + dielectric), 1e-6);
    CHECK_NEAR(reflectance_at_normal("conductor", "eta=1 k=1e3"), metal, 1e-6);
    CHECK_NEAR(reflectance_at_normal("conductor", "eta=1e3 k=0"), dielectric, 1e-6);
}

// Value of a material for light and eye 30 degrees from the normal in one plane.
static spectrum value_near_mirror(const char *name, const char *overrides) {
    struct arena arena = {0};
    static struct closure_stack stack;
    const struct bsdf_point point = bsdf_case_point();
    float pdf;
    stack.used = 0;
    const struct object *o = make_bsdf(&arena, name, overrides, NULL);
    const struct closure *c = bsdf_resolve(o, &point, v3(0.5f, 0, sqrtf(0.75f)), &stack);
    const spectrum f = closure_eval(c, v3(-0.5f, 0, sqrtf(0.75f)), &pdf);
    arena_finish(&arena);
    return f;
}

// The metal of principled does not depend on the index of its dielectric part, at 1 neither.
static void principled_metal_stays_at_index_one(void) {
    const spectrum none = value_near_mirror("principled", "metallic=1 specular=0");
    const spectrum some = value_near_mirror("principled", "metallic=1 specular=1e-6");
    CHECK(spectrum_min(none) > 0.1f);
    CHECK_NEAR(spectrum_max(none), spectrum_max(some), 1e-5);
}

// ---- in between -----------------------------------------------------------------------------

// Mean weight of samples on a lattice of three dimensions.
static double mean_weight(const struct object *o, vec3 wo) {
    enum { N = 20011 };
    static struct closure_stack stack;
    const struct bsdf_point point = bsdf_case_point();
    double sum = 0;
    stack.used = 0;
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    for (int i = 0; i < N; i++) {
        struct bsdf_sample s;
        const double u = (i + 0.5) / N, v = i * 0.8191725134, w = i * 0.6710436067;
        if (closure_sample(c, (float)u, (struct vec2){(float)(v - floor(v)), (float)(w - floor(w))},
                           &s))
            sum += (double)spectrum_mean(s.weight);
    }
    return sum / N;
}

// White plastic whose colours shift inside returns all that arrives, whatever its coat's index: a
// bound that is met. The mean weight over a lattice, right to a thousandth.
static void white_plastic_returns_everything(void) {
    static const char *const indices[] = {"1", "1.0000001", "1.5", "1e3"};
    const char *const models[][2] = {
        {"plastic", "nonlinear=true"},
        {"plastic", ""},
        {"roughplastic", "alpha=0.3 energy=compensated distribution=ggx nonlinear=true"}};
    for (int m = 0; m < 3; m++)
        for (size_t k = 0; k < sizeof indices / sizeof *indices; k++) {
            struct arena arena = {0};
            const struct object *o = make_bsdf(
                &arena, models[m][0],
                arena_printf(&arena, "%s diffuse_reflectance=1 ext_ior=1 int_ior=%s", models[m][1],
                             indices[k]), NULL);
            const double mean = mean_weight(o, direction(0.6f, 1, 1));
            CHECK_NEAR(mean, 1, 2e-3);
            arena_finish(&arena);
        }
}

enum { LIT = 3 };

// Values of the model from 50 degrees to three directions, cosines included.
static void values_at(const char *model, const char *more, double index, double value[LIT]) {
    static struct closure_stack stack;
    struct arena arena = {0};
    const struct bsdf_point point = bsdf_case_point();
    const vec3 lit[LIT] = {direction(0.7f, 3.3f, 1), direction(0.3f, 1, 1),
                           direction(0.95f, 3, -1)};
    stack.used = 0;
    const char *text = arena_printf(&arena, "%s ext_ior=1 int_ior=%.9g", more, index);
    const struct object *o = make_bsdf(&arena, model, text, NULL);
    const struct closure *c = bsdf_resolve(o, &point, direction(0.64f, 0.2f, 1), &stack);
    for (int i = 0; i < LIT; i++) {
        float pdf;
        value[i] = c ? (double)spectrum_mean(closure_eval(c, lit[i], &pdf)) : 0;
    }
    arena_finish(&arena);
}

static void check_steps(const char *model, const char *more, double from, double ratio) {
    for (double n = from; n < 1000; n *= ratio) {
        double before[LIT], after[LIT];
        values_at(model, more, n, before);
        values_at(model, more, n * 1.001, after);
        for (int i = 0; i < LIT; i++) {
            const bool follows = fabs(after[i] - before[i]) <= 0.02 * before[i] + 1e-7;
            CHECK(isfinite(before[i]) && follows);
            if (!follows)
                printf("%s %s: %g at %g, %g at %g\n", model, more, before[i], n, after[i],
                       n * 1.001);
        }
    }
}

// From an index of 1 to the next number.
static void check_start(const char *model, const char *more, double tolerance) {
    double none[LIT], least[LIT];
    values_at(model, more, 1, none);
    values_at(model, more, 1.0000001, least);
    CHECK(none[1] > 0.01);
    CHECK_NEAR(least[1] / none[1], 1, tolerance);
}

// A step of a thousandth in the index changes no value by more than a fiftieth; at 1 a coat begins
// from nothing. The tables that give energy back take long to make, and begin with what their
// quadrature may err by where facets refract (facet_albedo_error).
static void values_follow_the_index(void) {
    check_steps("plastic", "", 1.1, 1.7);
    check_steps("plastic", "nonlinear=true", 1.1, 1.7);
    check_steps("roughplastic", "alpha=0.4", 1.1, 1.7);
    check_steps("roughplastic", "alpha=0.4 energy=compensated", 300, 1000);
    check_steps("roughdielectric", "alpha=0.4", 1.1, 1.7);
    check_steps("roughdielectric", "alpha=0.4 energy=compensated", 300, 1000);
    check_start("plastic", "", 1e-4);
    check_start("plastic", "nonlinear=true", 1e-4);
    check_start("roughplastic", "alpha=0.4", 1e-4);
    check_start("roughplastic", "alpha=0.4 energy=compensated", 2.7e-3);
}

int main(void) {
    equal_indices_leave_nothing();
    nearly_equal_indices_leave_almost_nothing();
    large_indices_follow_fresnel();
    principled_metal_stays_at_index_one();
    white_plastic_returns_everything();
    values_follow_the_index();
    return check_result();
}
