// SPDX-License-Identifier: Apache-2.0
// Every phase function: its integral is 1, samples follow it (chi-square over deflection and over
// azimuth), the mean cosine is as stated, and nothing is lost at the narrowest peaks. All chi-square
// tests together raise a false alarm with probability 1e-3; seeds are fixed.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "make_object.h"
#include "math/hash.h"
#include "phase/phase.h"
#include "statistics.h"

enum { BINS = 64, SAMPLES = 200000, TESTS = 64 };

static const struct {
    const char *name, *parameters;
} cases[] = {
    {"isotropic", NULL},
    {"hg", "g=0"},
    {"hg", "g=0.3"},
    {"hg", "g=-0.3"},
    {"hg", "g=0.9"},
    {"hg", "g=-0.9"},
    {"hg", "g=0.99"},
    {"hg", "g=-0.99"},
    {"rayleigh", NULL},
    {"blendphase", "weight=0.25"},
    {"tabphase", "values=1,1"},
    {"tabphase", "values=0.5,1.0,1.5,4"},
    {"tabphase", "values=3,0,0,1,0"},
};

// Both ends of [0, 2] finely: 1 - cosine for x in [0, 1].
static double forward_at(double x) {
    const double a = pow(x, 4), b = pow(1 - x, 4);
    return 2 * a / (a + b);
}

static double x_of(struct deflection c) {
    const double r = sqrt(sqrt((double)c.backward / (double)c.forward));
    return 1 / (1 + r);
}

static struct deflection deflection_at(double x) {
    return (struct deflection){(float)forward_at(x), (float)forward_at(1 - x)};
}

// Probability of a bin, and its share of the mean cosine.
static double integrate(const struct object *phase, int bin, double *mean) {
    enum { STEPS = 400 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        const double a = (bin + (double)i / STEPS) / BINS, b = (bin + (i + 1.0) / STEPS) / BINS;
        const struct deflection c = deflection_at((a + b) / 2);
        const double share = 2 * (double)PI * (forward_at(b) - forward_at(a)) *
                             (double)phase_type_of(phase)->pdf_sa(phase->data, v3(0, 0, 0), c);
        sum += share;
        *mean += share * (1 - forward_at((a + b) / 2));
    }
    return sum;
}

static void test_deflections(const struct object *phase, const char *what) {
    struct rng rng = {7};
    struct chi2_bins chi2 = {.slack = 1};
    double counts[BINS] = {0}, total = 0, mean = 0;
    const struct phase_type *type = phase_type_of(phase);
    for (int i = 0; i < SAMPLES; i++) {
        const float u1 = rng_float(&rng);
        const struct deflection c = type->sample(phase->data, v3(0, 0, 0), u1, rng_float(&rng));
        CHECK(c.forward >= 0 && c.forward <= 2 && c.backward >= 0 && c.backward <= 2);
        const int bin = (int)(x_of(c) * BINS);
        counts[bin < BINS ? bin : BINS - 1]++;
    }
    for (int i = 0; i < BINS; i++) {
        const double p = integrate(phase, i, &mean);
        total += p;
        chi2_add(&chi2, counts[i], p * SAMPLES);
    }
    const double p_value = chi2_finish(&chi2);
    printf("%-24s integral %.6f, mean cosine %+.5f, chi-square p %.3f\n", what, total, mean, p_value);
    CHECK_NEAR(total, 1, 1e-4);
    CHECK_NEAR(mean, (double)type->mean_cosine(phase->data, v3(0, 0, 0)), 2e-4);
    CHECK(p_value > sidak(1e-3, TESTS));
}

// Directions: density as evaluated, unit length, uniform azimuth.
static void test_directions(const struct object *phase) {
    enum { SECTORS = 16 };
    struct rng rng = {11};
    struct chi2_bins chi2 = {.slack = 1};
    double counts[SECTORS] = {0};
    const vec3 wo = normalize(v3(0.3f, -0.8f, 0.5f));
    const struct frame frame = frame_from_normal(-wo);
    for (int i = 0; i < SAMPLES; i++) {
        float pdf;
        const float u1 = rng_float(&rng), u2 = rng_float(&rng);
        const vec3 wi = phase_sample(phase, v3(0, 0, 0), wo, u1,
                                     (struct vec2){u2, rng_float(&rng)}, &pdf);
        const vec3 local = to_local(&frame, wi);
        CHECK(fabsf(length(wi) - 1) < 1e-6f && pdf > 0 && isfinite(pdf));
        CHECK(fabsf(phase_pdf_sa(phase, v3(0, 0, 0), wo, wi) / pdf - 1) < 1e-2f);
        const double turn = atan2((double)local[1], (double)local[0]) / (2 * (double)PI);
        counts[(int)((turn - floor(turn)) * SECTORS) % SECTORS]++;
    }
    for (int i = 0; i < SECTORS; i++)
        chi2_add(&chi2, counts[i], (double)SAMPLES / SECTORS);
    CHECK(chi2_finish(&chi2) > sidak(1e-3, TESTS));
}

static struct object *make(struct arena *arena, const char *name, const char *parameters) {
    const struct object *forward = make_object(arena, &phases, "hg", "g=0.8", NULL);
    const struct object *back = make_object(arena, &phases, "hg", "g=-0.5", NULL);
    const struct object *const parts[] = {forward, back, NULL};
    struct object *o = make_object(arena, &phases, name, parameters,
                                   strcmp(name, "blendphase") == 0 ? parts : NULL);
    CHECK(!phase_type_of(o)->prepare || phase_type_of(o)->prepare(o, arena));
    return o;
}

// Every entry has a case above.
static void test_all_listed(void) {
    for (const struct entry *const *e = phases.entries; *e; e++) {
        bool listed = false;
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
            listed |= strcmp(cases[i].name, (*e)->name) == 0;
        CHECK(listed);
    }
}

// Finite at the ends of the range, and the mean cosine by sampling, to 5 standard errors.
static void test_narrowest(struct arena *arena) {
    static const char *const ends[] = {"g=0.999999", "g=-0.999999"};
    for (int i = 0; i < 2; i++) {
        const struct object *phase = make(arena, "hg", ends[i]);
        const float from_peak = 1 - 0.999999f;
        struct rng rng = {3};
        double sum = 0, squares = 0;
        for (int k = 0; k < SAMPLES; k++) {
            const struct deflection c =
                phase_hg.sample(phase->data, v3(0, 0, 0), 0, rng_float(&rng));
            const double x = (double)(i ? c.backward : c.forward);
            CHECK(isfinite(phase_hg.pdf_sa(phase->data, v3(0, 0, 0), c)));
            sum += x;
            squares += x * x;
        }
        const double mean = sum / SAMPLES, error = sqrt(squares) / SAMPLES;
        CHECK_NEAR(mean, (double)from_peak, 5 * error);
    }
}

int main(void) {
    struct arena arena = {0};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char what[64];
        const struct object *phase = make(&arena, cases[i].name, cases[i].parameters);
        snprintf(what, sizeof what, "%s %s", cases[i].name,
                 cases[i].parameters ? cases[i].parameters : "");
        test_deflections(phase, what);
        test_directions(phase);
    }
    test_all_listed();
    test_narrowest(&arena);
    arena_finish(&arena);
    return check_result();
}
