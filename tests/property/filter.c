// SPDX-License-Identifier: Apache-2.0
// Every filter of the registry and its sampler:
//
//  - sampled offsets against |f(x) f(y)| (chi-square over a grid, both signs apart);
//  - the weight is constant up to the filter's sign, its mean is 1, and the weighted second moment
//    is the filter's (z-test);
//  - the table's density differs from the ideal one by less than 1e-3 where f exceeds 0.1;
//  - x grows with u inside the main lobe, so that stratification survives.
// All statistical tests together raise a false alarm with probability 1 % (Sidak), once per choice
// of seeds.
#include <stdlib.h>

#include "check.h"
#include "filter/filter.h"
#include "make_object.h"
#include "math/hash.h"
#include "statistics.h"

enum { SAMPLES = 400000, BINS = 24, FINE = 1000, MOST_TESTS = 128 };

static const double FALSE_ALARMS = 0.01;
static double tested[MOST_TESTS];
static const char *tested_name[MOST_TESTS];
static int tested_count;

static void add_p_value(const char *name, double p) {
    tested_name[tested_count] = name;
    tested[tested_count++] = p;
}

// Integrals of the positive and the negative part, and of x^2 f, over [a, b], by midpoints.
struct parts {
    double positive, negative, second;
};

static struct parts integrate(const struct object *o, double a, double b) {
    const struct filter_type *type = (const struct filter_type *)(const void *)o->type;
    struct parts p = {0, 0, 0};
    for (int i = 0; i < FINE; i++) {
        const double x = a + (b - a) * (i + 0.5) / FINE;
        const double f = (double)type->eval(o->data, (float)x) * (b - a) / FINE;
        p.positive += fmax(f, 0);
        p.negative += fmax(-f, 0);
        p.second += x * x * f;
    }
    return p;
}

static void check_sampling(struct object *o, const char *name) {
    static int count[2][BINS * BINS];
    struct filter_sampler s;
    struct parts bin[BINS], all = {0, 0, 0};
    CHECK(filter_sampler_init(&s, o));
    const double r = (double)s.radius;
    for (int i = 0; i < BINS; i++) {
        bin[i] = integrate(o, r * (2.0 * i / BINS - 1), r * (2.0 * (i + 1) / BINS - 1));
        all.positive += bin[i].positive;
        all.negative += bin[i].negative;
        all.second += bin[i].second;
    }
    const double mass = all.positive + all.negative, integral = all.positive - all.negative;
    const double weight = mass * mass / (integral * integral);
    double sum = 0, second = 0, second2 = 0;
    struct rng rng = {11};
    for (int i = 0; i < 2 * BINS * BINS; i++)
        count[i / (BINS * BINS)][i % (BINS * BINS)] = 0;
    for (int i = 0; i < SAMPLES; i++) {
        float w;
        const struct vec2 u = {rng_float(&rng), rng_float(&rng)};
        const struct vec2 d = filter_sample(&s, u, &w);
        CHECK(fabsf(d.x) <= s.radius && fabsf(d.y) <= s.radius);
        CHECK_NEAR(fabs((double)w) / weight, 1, 1e-3);
        const int x = (int)fmin(BINS * (0.5 + 0.5 * (double)d.x / r), BINS - 1);
        const int y = (int)fmin(BINS * (0.5 + 0.5 * (double)d.y / r), BINS - 1);
        count[w < 0][y * BINS + x]++;
        sum += (double)w / SAMPLES;
        const double m = (double)w * (double)d.x * (double)d.x;
        second += m / SAMPLES;
        second2 += m * m / SAMPLES;
    }
    struct chi2_bins bins = {0};
    for (int i = 0; i < BINS * BINS; i++) {
        const struct parts a = bin[i % BINS], b = bin[i / BINS];
        const double scale = SAMPLES / (mass * mass);
        chi2_add(&bins, count[0][i],
                 (a.positive * b.positive + a.negative * b.negative) * scale);
        chi2_add(&bins, count[1][i],
                 (a.positive * b.negative + a.negative * b.positive) * scale);
    }
    const double weight_error = sqrt(fmax(weight * weight - 1, 0) / SAMPLES);
    const double expected = all.second / integral;
    const double error = sqrt(fmax(second2 - second * second, 0) / SAMPLES);
    add_p_value(name, chi2_finish(&bins));
    add_p_value(name, normal_p_value((sum - 1) / fmax(weight_error, 1e-4)));
    add_p_value(name, normal_p_value((second - expected) / error));
    printf("%-34s radius %.2f  weight %.5f  mean weight %.5f  second moment %.5f, expected %.5f\n",
           name, r, weight, sum, second, expected);
    filter_sampler_finish(&s);
}

// The density of the table along one axis, from the steps of x over steps of u.
static void check_density(struct object *o, const char *name) {
    enum { STEPS = 400 };
    struct filter_sampler s;
    CHECK(filter_sampler_init(&s, o));
    const struct parts all = integrate(o, 0, (double)s.radius);
    double worst = 0, last = -INFINITY;
    bool grows = true;
    // the positive part, the main lobe in its middle, is sampled first
    const double share = all.positive / (all.positive + all.negative);
    for (int i = 1; i < STEPS; i++) {
        float w;
        const double u0 = share * i / STEPS, du = share * 2e-3;
        if (u0 + du >= share)
            break;
        const struct vec2 a = {(float)u0, 0.25f}, b = {(float)(u0 + du), 0.25f};
        const double x0 = (double)filter_sample(&s, a, &w).x;
        const double x1 = (double)filter_sample(&s, b, &w).x;
        const double width = (double)b.x - (double)a.x;
        grows = grows && x0 >= last;
        last = x0;
        const struct parts p = integrate(o, fmin(x0, x1), fmax(x0, x1));
        if (p.positive > 0.1 * width && x0 * x1 > 0)
            worst = fmax(worst, fabs(p.positive / (2 * (all.positive + all.negative)) / width - 1));
    }
    printf("%-34s density differs by %.1e at most where f exceeds 0.1\n", name, worst);
    CHECK(grows && worst < 1e-3);
    filter_sampler_finish(&s);
}

int main(void) {
    static const char *const cases[][2] = {
        {"box", ""}, {"box", "radius=1.5"}, {"tent", ""}, {"tent", "radius=2"}, {"gaussian", ""},
        {"gaussian", "stddev=0.1"}, {"gaussian", "stddev=2"}, {"mitchell", ""},
        {"mitchell", "B=1 C=0"}, {"mitchell", "B=0 C=1"}, {"catmullrom", ""}, {"lanczos", ""},
        {"lanczos", "lobes=1"}, {"lanczos", "lobes=8"}};
    enum { COUNT = sizeof cases / sizeof *cases };
    struct arena arena = {0};
    static char names[COUNT][64];
    for (int i = 0; i < COUNT; i++) {
        struct object *o = make_object(&arena, &filters, cases[i][0], cases[i][1], NULL);
        snprintf(names[i], sizeof names[0], "%s %s", cases[i][0], cases[i][1]);
        check_sampling(o, names[i]);
        check_density(o, names[i]);
    }
    for (const struct entry *const *e = filters.entries; *e; e++) { // none is left out above
        bool found = false;
        for (int i = 0; i < COUNT; i++)
            found = found || registry_find(&filters, cases[i][0]) == *e;
        CHECK(found);
    }
    const double least = sidak(FALSE_ALARMS, tested_count);
    for (int i = 0; i < tested_count; i++) {
        if (tested[i] < least)
            printf("%s: p = %.3g, expected at least %.3g\n", tested_name[i], tested[i], least);
        CHECK(tested[i] >= least);
    }
    arena_finish(&arena);
    return check_result();
}
