// SPDX-License-Identifier: Apache-2.0
// Cases of lights that have a density, and what is checked of each:
//
//  - samples against pdf_sa: chi-square over charts of the light, refused samples as a bin of their
//    own, expected counts by quadrature. All of a file together raise a false alarm with
//    probability 1 % (Sidak), once per choice of seeds;
//  - a sample's density and emission equal pdf_sa and emission of the hit at the same place;
//  - the mean of emission / pdf equals the integral of the emission (z-test, counted above);
//  - the power of infinite lights equals the integral to 10 %.
#pragma once

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
    struct rng rng = {hash_u64((uint64_t)((chart * c->ky + y) * c->kx + x))};
    const int n = c->midpoints ? c->midpoints : 4 * PANELS;
    struct pair sum = {0, 0};
    for (int i = 0; i < n * n; i++) {
        const int a = i % n, b = i / n;
        const double da = c->edges ? (double)rng_float(&rng) : 0.5;
        const double db = c->edges ? (double)rng_float(&rng) : 0.5;
        const double s = c->midpoints ? (a + da) / n : (a / 4 + node[a % 4]) / PANELS;
        const double t = c->midpoints ? (b + db) / n : (b / 4 + node[b % 4]) / PANELS;
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
    double worst_pdf, worst_emission; // relative differences
};

static double difference(float a, float b) {
    return (double)(fabsf(a - b) / fmaxf(fmaxf(a, b), 1e-30f));
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
    out->worst_pdf = worst_of(out->worst_pdf, difference(pdf, x->pdf_sa));
    out->worst_emission = worst_of(out->worst_emission, difference(spectrum_luminance(e),
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
           c->name, total.a, mean, sqrt(variance), integral, tally.worst_pdf);
    CHECK(c->may_be_empty || total.a > 0.2);
    CHECK(tally.worst_pdf < 2e-3 && tally.worst_emission < 2e-3);
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

static struct shape *meshes[16];
static int mesh_count;

static struct shape *keep_mesh(struct shape *s) {
    meshes[mesh_count++] = s;
    return s;
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

// ---- all of them

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void check_cases(void) {
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
}

static void finish_cases(void) {
    for (int i = 0; i < case_count; i++)
        if (case_type(&cases[i])->finish && (i == 0 || cases[i].light != cases[i - 1].light))
            case_type(&cases[i])->finish(cases[i].light->data);
    for (int i = 0; i < mesh_count; i++)
        mesh_finish(&meshes[i]->mesh);
    arena_finish(&arena);
}
