// SPDX-License-Identifier: Apache-2.0
// The classic reflection models at the ends of their parameters: smooth ones become mirrors, flat
// diffuse ones Lambertian, indices near 1 vanish; weights stay bounded up to grazing angles of
// 89.999 degrees, and what is reflected approaches a limit there.
#include <stdio.h>

#include "check.h"
#include "math/cook_torrance.h"
#include "math/hash.h"
#include "math/schlick.h"
#include "property/bsdf_cases.h"

enum { SIDE = 64 }; // squared: random numbers of a run

struct reflected {
    double mean;     // of the weight (channel mean)
    double mirrored; // the part of it within 1 degree of the mirror direction
    double greatest; // weight
};

static vec3 seen_from(double degrees) {
    const double t = degrees * (M_PI / 180);
    return v3((float)(sin(t) * cos(0.4)), (float)(sin(t) * sin(0.4)), (float)cos(t));
}

// By stratified random numbers; the third is shuffled by a generator of the integers.
static struct reflected reflect_from(const struct object *o, vec3 wo) {
    static struct closure_stack stack;
    const struct bsdf_point point = bsdf_case_point();
    const vec3 mirror = v3(-wo[0], -wo[1], wo[2]);
    struct reflected r = {0, 0, 0};
    stack.used = 0;
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    for (int i = 0; c && i < SIDE * SIDE; i++) {
        struct bsdf_sample s;
        const float u1 = ((float)(i * 1597 % (SIDE * SIDE)) + 0.5f) / (SIDE * SIDE);
        const struct vec2 u = {((float)(i % SIDE) + 0.5f) / SIDE,
                               (floorf((float)i / SIDE) + 0.5f) / SIDE};
        if (!closure_sample(c, u1, u, &s))
            continue;
        const double w = (double)spectrum_mean(s.weight);
        CHECK(isfinite(w) && w >= 0 && isfinite(s.pdf_sa) && s.pdf_sa > 0);
        r.mean += w / (SIDE * SIDE);
        r.mirrored += length(s.wi - mirror) < 0.0174f ? w / (SIDE * SIDE) : 0;
        r.greatest = fmax(r.greatest, w);
    }
    return r;
}

static struct object *make(struct arena *arena, const char *text) {
    char name[64];
    bsdf_first_word(text, name, sizeof name);
    return make_bsdf(arena, name, text + strlen(name), NULL);
}

// ---- limits of roughness --------------------------------------------------------------------

static double one(double c) {
    (void)c;
    return 1;
}

static double cosine(double c) {
    return c;
}

static double schlick_004(double c) {
    return schlick_fresnel(c, 0.04);
}

// What A loses.
static double schlick_stretched(double c) {
    return schlick_004(c) * schlick_azimuth_make(0.5).mean;
}

static double metal(double c) {
    return conductor_reflectance(c, 0.2, 3);
}

static double root_of_cosine(double c) {
    return sqrt(c);
}

static void smooth_models_are_mirrors(void) {
    static const struct {
        const char *text;
        double (*limit)(double cos_o);
    } rows[] = {
        {"phong diffuse_reflectance=0 specular_reflectance=1 exponent=1e7", cosine},
        {"lafortune diffuse_reflectance=0 specular_reflectance_1=1 exponent_1=1e7", cosine},
        {"blinnphong diffuse_reflectance=0 specular_reflectance=1 exponent=1e7", one},
        {"blinnphong diffuse_reflectance=0 specular_reflectance=1 exponent=1e8 r0=0.04",
         schlick_004},
        {"cooktorrance alpha=1e-6 eta=0.2 k=3", metal},
        {"ashikhminshirley diffuse_reflectance=0 specular_reflectance=0.04 exponent_u=1e8 "
         "exponent_v=1e8", schlick_004},
        {"ward diffuse_reflectance=0 specular_reflectance=1 alpha_u=1e-6 alpha_v=1e-6", one},
        {"ward diffuse_reflectance=0 specular_reflectance=1 alpha_u=1e-6 alpha_v=1e-6 variant=ward",
         cosine},
        {"ward diffuse_reflectance=0 specular_reflectance=1 alpha_u=1e-6 alpha_v=1e-6 "
         "variant=ward-duer", one},
        {"schlick diffuse_reflectance=0 specular_reflectance=0.04 roughness=0", schlick_004},
        {"schlick diffuse_reflectance=0 specular_reflectance=0.04 roughness=0 isotropy=0.5",
         schlick_stretched},
        {"kskk mx_1=1e-6 alpha_1=0.25", root_of_cosine},
        {"kskk mx_1=1e-6 alpha_1=0.5", one},
        {"kskk mx_1=1e-6 alpha_1=0.9", one}, // bounded
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct arena arena = {0};
        const struct object *o = make(&arena, rows[i].text);
        for (int k = 0; k < 5; k++) {
            const double angle = (double[]){0, 30, 60, 75, 85}[k];
            const double expected = rows[i].limit(cos(angle * (M_PI / 180)));
            const double got = reflect_from(o, seen_from(angle)).mirrored;
            if (fabs(got / expected - 1) > 1e-3)
                printf("%s from %g degrees:\n", rows[i].text, angle);
            CHECK_NEAR(got / expected, 1, 1e-3);
        }
        arena_finish(&arena);
    }
}

static void flat_diffuse_models_are_lambertian(void) {
    static const char *const rows[] = {"orennayar alpha=0", "orennayar alpha=1e-6",
                                       "orennayar alpha=1e-6 use_fast_approx=true",
                                       "eon roughness=0", "eon roughness=1e-6"};
    static struct closure_stack stack;
    const struct bsdf_point point = bsdf_case_point();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct arena arena = {0};
        struct rng rng = {3};
        const struct object *o = make(&arena, rows[i]);
        for (int k = 0; k < 1000; k++) {
            const float a = rng_float(&rng), b = rng_float(&rng);
            const vec3 wo = seen_from(89.9 * (double)a), wi = seen_from(89.9 * (double)b);
            float pdf;
            stack.used = 0;
            const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
            const spectrum f = closure_eval(c, wi, &pdf);
            CHECK_NEAR(f[0] / (0.5f * wi[2] * INV_PI), 1, 1e-4);
        }
        arena_finish(&arena);
    }
}

// ---- extreme indices -------------------------------------------------------------------------

static void extreme_indices_reflect_nothing_or_all(void) {
    static const struct {
        const char *text;
        double least, most;
    } rows[] = {
        {"cooktorrance alpha=0.1 eta=1 k=0", 0, 0},
        {"cooktorrance alpha=0.1 eta=1.0000001 k=0", 0, 1e-10},
        {"cooktorrance alpha=0.01 eta=1000 k=0", 0.99, 1},
        {"cooktorrance alpha=0.01 eta=1 k=1000", 0.99, 1},
        {"cooktorrance alpha=0.01 eta=1000 k=1000", 0.99, 1},
        {"blinnphong diffuse_reflectance=0 specular_reflectance=1 r0=0 exponent=1e5", 0, 1e-10},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct arena arena = {0};
        const double got = reflect_from(make(&arena, rows[i].text), seen_from(1)).mean;
        CHECK(got >= rows[i].least && got <= rows[i].most);
        arena_finish(&arena);
    }
}

// ---- grazing angles ---------------------------------------------------------------------------

// No weight above `most`; from 89.999 degrees and 5 % nearer to the horizon nearly the same is
// reflected.
static void check_grazing(const char *text, double most) {
    static const double angles[] = {0, 45, 80, 89, 89.9, 89.999, 89.99905};
    struct arena arena = {0};
    const struct object *o = make(&arena, text);
    struct reflected r[7];
    for (int i = 0; i < 7; i++) {
        r[i] = reflect_from(o, seen_from(angles[i]));
        if (r[i].greatest > most)
            printf("%s from %g degrees: weight %g\n", text, angles[i], r[i].greatest);
        CHECK(r[i].greatest <= most);
    }
    if (fabs(r[6].mean - r[5].mean) > 0.01)
        printf("%s: %.4f from 89.9 degrees, %.4f from 89.999, %.4f from 89.99905\n", text,
               r[4].mean, r[5].mean, r[6].mean);
    CHECK_NEAR(r[6].mean, r[5].mean, 0.01);
    arena_finish(&arena);
}

static void weights_stay_bounded_at_all_angles(void) {
    static const char *const exponents[] = {"1e-3", "1", "100", "1e4", "1e7"};
    static const char *const alphas[] = {"1e-6", "1e-3", "0.03", "0.3", "1"};
    struct arena arena = {0};
    for (int i = 0; i < 5; i++) {
        const char *n = exponents[i], *a = alphas[i];
        check_grazing(arena_printf(&arena, "phong diffuse_reflectance=0 specular_reflectance=1 "
                                   "exponent=%s", n), 2);
        check_grazing(arena_printf(&arena, "lafortune diffuse_reflectance=0 c_1=-1,-0.7,0.9 "
                                   "specular_reflectance_1=1 exponent_1=%s", n), 2);
        check_grazing(arena_printf(&arena, "blinnphong diffuse_reflectance=0 "
                                   "specular_reflectance=1 exponent=%s", n), 1 + 1e-6);
        check_grazing(arena_printf(&arena, "ashikhminshirley diffuse_reflectance=0 "
                                   "specular_reflectance=1 exponent_u=%s exponent_v=%s", n, n),
                      1 + 1e-6);
        check_grazing(arena_printf(&arena, "cooktorrance alpha=%s", a), 1 + 1e-6);
        check_grazing(arena_printf(&arena, "ward diffuse_reflectance=0 specular_reflectance=1 "
                                   "alpha_u=%s alpha_v=%s", a, a), 1 + 1e-6);
        check_grazing(arena_printf(&arena, "ward diffuse_reflectance=0 specular_reflectance=1 "
                                   "alpha_u=%s alpha_v=1", a), 1 + 1e-6);
        check_grazing(arena_printf(&arena, "eon reflectance=1 roughness=%s", a), 2);
        check_grazing(arena_printf(&arena, "orennayar reflectance=1 alpha=%s", a), 6);
    }
    arena_finish(&arena);
}

int main(void) {
    smooth_models_are_mirrors();
    flat_diffuse_models_are_lambertian();
    extreme_indices_reflect_nothing_or_all();
    weights_stay_bounded_at_all_angles();
    return check_result();
}
