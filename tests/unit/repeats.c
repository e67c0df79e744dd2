// SPDX-License-Identifier: Apache-2.0
// Bias and variance from repeated runs of known ones, and lines through points.
#include "check.h"

#include <string.h>

#include "math/hash.h"
#include "math/line_fit.h"
#include "math/repeats.h"
#include "math/student.h"
#include "statistics.h"

enum { PIXELS = 300, MOST_RUNS = 8 };

// A standard normal deviate that is a function of its index (Box and Muller 1958).
static double normal(uint32_t index) {
    const double u = (hash_u32(2 * index) + 0.5) / 4294967296.0;
    const double v = (hash_u32(2 * index + 1) + 0.5) / 4294967296.0;
    return sqrt(-2 * log(u)) * cos(2 * 3.14159265358979 * v);
}

struct truth {
    double bias, noise, reference; // of every pixel: standard deviations, and the bias
    int runs;
    double shared; // part of the noise's variance that all pixels of a run have in common
};

// One study of a synthetic picture: truth 0, reference of known noise.
static struct repeats study(const struct truth *t, uint32_t trial) {
    static double errors[MOST_RUNS][PIXELS];
    double gram[MOST_RUNS * MOST_RUNS], e2 = 0;
    const uint32_t base = trial * (MOST_RUNS + 1) * (PIXELS + 1);
    for (int p = 0; p < PIXELS; p++) {
        const double d = t->reference * normal(base + (uint32_t)p);
        double mean = 0;
        for (int i = 0; i < t->runs; i++) {
            const uint32_t at = base + (uint32_t)((i + 1) * (PIXELS + 1));
            errors[i][p] = t->bias - d + t->noise * sqrt(1 - t->shared) * normal(at + (uint32_t)p) +
                           t->noise * sqrt(t->shared) * normal(at + PIXELS);
            mean += errors[i][p] / t->runs;
        }
        e2 += mean * mean;
    }
    for (int i = 0; i < t->runs; i++)
        for (int j = 0; j < t->runs; j++) {
            gram[i * t->runs + j] = 0;
            for (int p = 0; p < PIXELS; p++)
                gram[i * t->runs + j] += errors[i][p] * errors[j][p] / PIXELS;
        }
    const double v = t->reference * t->reference;
    const double variance = (4 * e2 * v - 2 * v * v * PIXELS) / PIXELS / PIXELS;
    return repeats_measure(gram, t->runs, v, sqrt(fmax(variance, 0)));
}

struct tally {
    double sum, sum2;
    int outside;
};

static void count(struct tally *y, const struct measured *m, double expected) {
    y->sum += m->value;
    y->sum2 += m->value * m->value;
    y->outside += !(m->low <= expected && expected <= m->high);
}

enum { TRIALS = 4000 };

// Four thousand studies: the means are the known values (false alarms: 1e-4 a mean), and the 95 %
// intervals miss them in at most 8 % of the studies: 5 % are wished for, fewer come where there is no
// bias, or where the reference's noise counts, and a few more where two kinds of noise meet. With
// bias, and a reference without noise, they may not be wider than needed either.
static void check_truth(const struct truth *t, const char *what) {
    const double expected[3] = {t->bias * t->bias + t->noise * t->noise, t->bias * t->bias,
                                t->noise * t->noise};
    static const char *const names[3] = {"mse", "bias2", "variance"};
    struct tally tally[3] = {{0}};
    for (uint32_t i = 0; i < TRIALS; i++) {
        const struct repeats r = study(t, i);
        const struct measured *m[3] = {&r.mse, &r.bias2, &r.variance};
        CHECK_NEAR(r.bias2.value + r.variance.value, r.mse.value, 1e-9);
        for (int k = 0; k < 3; k++)
            count(&tally[k], m[k], expected[k]);
    }
    for (int k = 0; k < 3; k++) {
        const double mean = tally[k].sum / TRIALS;
        const double error = sqrt((tally[k].sum2 / TRIALS - mean * mean) / TRIALS);
        printf("%s, %s: mean %.6f of %.6f (%+.2f errors), %.1f %% outside\n", what, names[k], mean,
               expected[k], (mean - expected[k]) / error, 100.0 * tally[k].outside / TRIALS);
        CHECK(normal_p_value((mean - expected[k]) / error) > sidak(1e-3, 10));
        CHECK(tally[k].outside < 0.08 * TRIALS);
        CHECK(t->bias == 0 || t->reference > 0 || tally[k].outside > 0.02 * TRIALS);
    }
}

static void repeats_finds_known_bias_and_variance(void) {
    check_truth(&(struct truth){.bias = 0, .noise = 0.3, .runs = 5}, "no bias");
    check_truth(&(struct truth){.bias = 0.2, .noise = 0.3, .runs = 5}, "bias");
    check_truth(&(struct truth){.bias = 0.01, .noise = 0.3, .reference = 0.05, .runs = 5},
                "little bias, noisy reference");
    check_truth(&(struct truth){.bias = 0, .noise = 0.1, .reference = 0.1, .runs = 4},
                "reference as noisy as a run");
    check_truth(&(struct truth){.bias = 0.1, .noise = 0.2, .runs = 8}, "eight runs");
    check_truth(&(struct truth){.bias = 0.1, .noise = 0.2, .runs = 3}, "three runs");
    // a method whose pixels share their samples, such as virtual lights
    check_truth(&(struct truth){.bias = 0.1, .noise = 0.2, .shared = 0.02, .runs = 5}, "shared noise");
}

static void repeats_of_two_runs_have_no_error(void) {
    const double gram[] = {2, 1, 1, 4};
    const struct repeats r = repeats_measure(gram, 2, 0.5, 0);
    CHECK_NEAR(r.mse.value, 2.5, 1e-12);
    CHECK_NEAR(r.bias2.value, 0.5, 1e-12);
    CHECK_NEAR(r.variance.value, 2, 1e-12);
    CHECK(isnan(r.bias2.error) && isinf(r.bias2.low) && isinf(r.bias2.high));
}

static void student_quantiles(void) {
    CHECK_NEAR(student_95(1), 12.7062, 1e-3);
    CHECK_NEAR(student_95(4), 2.7764, 1e-3);
    CHECK_NEAR(student_95(6), 2.4469, 2e-3);
    CHECK_NEAR(student_95(11), 2.2010, 1e-3);
    CHECK_NEAR(student_95(30), 2.0423, 1e-3);
    CHECK_NEAR(student_95(1000000), 1.95996, 1e-4);
}

// Probability that |t| is not exceeded: finite sums (Abramowitz and Stegun 1964, 26.7.3 and 26.7.4).
static double student_within(double t, int n) {
    const double theta = atan(t / sqrt(n)), c2 = cos(theta) * cos(theta);
    double term = n % 2 ? cos(theta) : 1, sum = n > 1 ? term : 0;
    for (int k = n % 2 ? 3 : 2; k < n; k += 2)
        sum += term *= c2 * (k - 1) / k;
    return n % 2 ? (theta + sin(theta) * sum) * 2 / M_PI : sin(theta) * sum;
}

// Far tails by the Cauchy distribution (1 degree of freedom) and in closed form (2).
static void student_p_values(void) {
    for (double t = 0.125; t < 1e4; t *= 1.7) {
        CHECK_NEAR(student_p_value(t, 1) / (2 / M_PI * atan(1 / t)), 1, 1e-11);
        const double root = sqrt(t * t + 2);
        CHECK_NEAR(student_p_value(-t, 2) / (2 / (root * (root + t))), 1, 1e-11);
        CHECK(student_p_value(t, 1e6) >= student_p_value(t, INFINITY));
    }
    for (int n = 1; n < 100; n += 1 + n / 8)
        for (double t = 0.1; t < 40; t *= 1.3)
            CHECK_NEAR(student_p_value(t, n), 1 - student_within(t, n), 1e-12);
    CHECK_NEAR(student_p_value(1.959963985, INFINITY), 0.05, 1e-9);
    CHECK_NEAR(student_p_value(-5, INFINITY), 5.733031e-7, 1e-12);
    CHECK(student_p_value(0, 15) == 1 && student_p_value(INFINITY, 15) == 0);
    CHECK(isnan(student_p_value(NAN, 15)));
    for (int n = 1; n <= 1000; n = 2 * n + 1)
        CHECK_NEAR(student_p_value(student_95(n), n), 0.05, 1e-4);
}

static void line_fit_finds_slope_and_error(void) {
    const double x[] = {0, 1, 2, 3}, y[] = {1, -1, -3, -5}, off[] = {1, -0.9, -3.1, -5};
    const double e[] = {0.1, 0.1, 0.1, 0.1};
    struct line_fit f;
    CHECK(line_fit(x, y, e, 4, &f));
    CHECK_NEAR(f.slope, -2, 1e-12);
    CHECK_NEAR(f.intercept, 1, 1e-12);
    CHECK_NEAR(f.slope_error, 0.1 / sqrt(5), 1e-12);
    CHECK(line_fit(x, off, NULL, 4, &f)); // residuals -0.02, 0.04, ... by hand: slope -2.02
    CHECK_NEAR(f.slope, -2.02, 1e-12);
    CHECK_NEAR(f.slope_error, sqrt(0.018 / 2 / 5), 1e-12);
    const double wild[] = {1, -1, 2, -5}, known[] = {0.1, 0.1, 1000, 0.1}; // a point far off
    CHECK(line_fit(x, wild, known, 4, &f));
    CHECK_NEAR(f.slope, -2, 1e-4);
    CHECK(f.slope_error > 0.03 && f.slope_error < 0.1);
    CHECK(line_fit(x, y, (const double[]){0.1, 0.1, 0.1, NAN}, 4, &f)); // not weighted
    CHECK_NEAR(f.slope, -2, 1e-12);
    CHECK(line_fit(x, y, NULL, 2, &f) && isnan(f.slope_error));
    CHECK(!line_fit(x, y, e, 1, &f));
    CHECK(!line_fit((const double[]){2, 2}, y, e, 2, &f));
}

int main(void) {
    repeats_finds_known_bias_and_variance();
    repeats_of_two_runs_have_no_error();
    student_quantiles();
    student_p_values();
    line_fit_finds_slope_and_error();
    return check_result();
}
