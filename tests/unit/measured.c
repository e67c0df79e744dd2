// SPDX-License-Identifier: Apache-2.0
// Materials of the RGL database against Mitsuba 3's plugin. Needs the large files.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "make_object.h"
#include "math/quadrature.h"

struct reference {
    const char *file;
    double v[10]; // eye, light, f cos in RGB, pdf
};

static const struct reference references[] = {
#include "rgl_references.inc"
};

static const char *const files[] = {"cc_ibiza_sunset_rgb.bsdf", "paper_white_rgb.bsdf",
                                    "satin_rosaline_rgb.bsdf", "vch_golden_yellow_rgb.bsdf"};

static vec3 direction(const double v[3]) {
    return normalize(v3((float)v[0], (float)v[1], (float)v[2]));
}

static const struct object *load(struct arena *arena, const char *file) {
    char overrides[4096];
    snprintf(overrides, sizeof overrides, "filename=%s/brdf/rgl/%s", getenv("RELUME_SHARED_DATA"),
             file);
    return make_bsdf(arena, "measured", overrides, NULL);
}

// Relative to Mitsuba's value. Both compute in single precision, and where the table falls to 0 in a
// cell its slope multiplies the rounding of the half vector: below 1e-3 the difference is absolute.
static double difference(double ours, double reference) {
    return fabs(ours - fmax(reference, 0)) / fmax(reference, 1e-3);
}

static void values_agree_with_mitsuba(struct arena *arena) {
    double worst_f = 0, worst_pdf = 0;
    for (size_t i = 0; i < sizeof references / sizeof *references; i++) {
        const struct reference *r = &references[i];
        struct closure_stack stack = {0};
        const struct bsdf_point point = {0};
        const struct object *o = load(arena, r->file);
        const struct closure *c = bsdf_resolve(o, &point, direction(r->v), &stack);
        float pdf;
        const spectrum f = closure_eval(c, direction(r->v + 3), &pdf);
        for (int k = 0; k < 3; k++)
            worst_f = fmax(worst_f, difference((double)f[k], r->v[6 + k]));
        worst_pdf = fmax(worst_pdf, difference((double)pdf, r->v[9]));
    }
    printf("largest relative difference to Mitsuba: f %.2g, pdf %.2g\n", worst_f, worst_pdf);
    CHECK(worst_f < 1e-4);
    CHECK(worst_pdf < 1e-4);
}

// Over all half vectors, hence also over directions below the horizon that the table reaches.
static double integrate_pdf(const struct closure *c, vec3 wo) {
    enum { N = 400 };
    double sum = 0;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            const double theta = (x + 0.5) * (M_PI / 2) / N, phi = (y + 0.5) * 2 * M_PI / N;
            const vec3 m = v3((float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)),
                              (float)cos(theta));
            const vec3 wi = normalize(reflect(wo, m));
            float pdf;
            if (!(dot(wo, m) > 0))
                continue;
            closure_eval(c, wi, &pdf);
            sum += (double)pdf * 4 * (double)dot(wo, m) * sin(theta);
        }
    return sum * (M_PI / 2 / N) * (2 * M_PI / N);
}

static double share_scattered(const struct closure *c) {
    enum { N = 256 };
    int scattered = 0;
    for (int i = 0; i < N * N; i++) {
        struct bsdf_sample s;
        const struct vec2 u = {((float)(i % N) + 0.5f) / N, ((float)(i / N) + 0.5f) / N};
        scattered += closure_sample(c, 0, u, &s);
    }
    return (double)scattered / (N * N);
}

// The density above the horizon, and what the sampler loses below it, make 1.
static void density_integrates_to_one(struct arena *arena) {
    static const double angles[] = {5, 35, 60, 75};
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 4; a++) {
            const double t = angles[a] * M_PI / 180;
            struct closure_stack stack = {0};
            const struct bsdf_point point = {0};
            const vec3 wo = v3((float)sin(t), 0, (float)cos(t));
            const struct closure *c = bsdf_resolve(load(arena, files[i]), &point, wo, &stack);
            const double integral = integrate_pdf(c, wo), scattered = share_scattered(c);
            printf("%s %g deg: integral of pdf %.4f, share of samples above the horizon %.4f\n",
                   files[i], angles[a], integral, scattered);
            CHECK_NEAR(integral, scattered, 4e-3);
        }
}

static void a_file_is_read_once(struct arena *arena) {
    const size_t before = arena->total;
    load(arena, files[0]);
    CHECK(arena->total - before < 10000);
}

int main(void) {
    struct arena arena = {0};
    if (!getenv("RELUME_SHARED_DATA"))
        return 77;
    values_agree_with_mitsuba(&arena);
    density_integrates_to_one(&arena);
    a_file_is_read_once(&arena);
    arena_finish(&arena);
    return check_result();
}
