// SPDX-License-Identifier: Apache-2.0
#include "image/ztest.h"

#include <float.h>
#include <math.h>

#include "math/student.h"

enum { BLOCK = 8 };

static const double level = 0.01, smallest_share = 0.9975, smallest_variance = 1e-4;

// Linear Rec.709 to CIE XYZ (D65), as in math/colour.h and Mitsuba. The variances of Mitsuba's
// references were turned from XYZ to RGB by the inverse matrix, like colours; so the same matrix
// brings them back.
static const double rgb_to_xyz[3][3] = {{0.412453, 0.357580, 0.180423},
                                        {0.212671, 0.715160, 0.072169},
                                        {0.019334, 0.119193, 0.950227}};

static void to_xyz(const float *rgb, double xyz[3]) {
    for (int i = 0; i < 3; i++) {
        xyz[i] = 0;
        for (int j = 0; j < 3; j++)
            xyz[i] += rgb_to_xyz[i][j] * (double)rgb[j];
    }
}

// Variances of X, Y, Z from those of R, G, B when nothing is known of their correlation: 1 is
// assumed, the upper bound (noise of a path tracer is nearly grey).
static void rgb_variance_to_xyz(const float *rgb, double xyz[3]) {
    for (int i = 0; i < 3; i++) {
        double error = 0;
        for (int j = 0; j < 3; j++)
            error += rgb_to_xyz[i][j] * sqrt(fmax((double)rgb[j], 0));
        xyz[i] = error * error;
    }
}

// A variance of a difference; spread: the sum of the squares of what it was found from, each over its
// degrees of freedom; 0: exact.
struct noise {
    double variance, spread;
};

static double degrees_of(const struct noise *n) {
    return n->spread > 0 ? n->variance * n->variance / n->spread : INFINITY;
}

// Sums over the pixels of a block.
struct sums {
    double ref[3], difference[3];
    struct noise noise[3]; // of the difference
};

static void start_level(struct ztest_level *l, size_t tests) {
    *l = (struct ztest_level){.p_limit = 1 - pow(1 - level, 1 / (double)tests),
                              .least_share = smallest_share};
}

static void count_value(struct ztest_level *l, double z, double degrees) {
    l->values++;
    if (!isfinite(z)) {
        l->largest_z = INFINITY;
        return;
    }
    l->agreeing += student_p_value(z, degrees) > l->p_limit;
    l->largest_z = fmax(l->largest_z, fabs(z));
}

static void finish_level(struct ztest_level *l) {
    l->share = l->values ? (double)l->agreeing / (double)l->values : 0;
    l->pass = l->share >= l->least_share;
}

static bool both_tell_errors(const struct ztest_input *in) {
    return in->ref_variance && in->test_variance;
}

// Of the difference of a value; both variances may be `single` over the samples, and then vary as one.
static struct noise noise_of(const struct ztest_input *in, double ref, double test) {
    const double sum = ref + test;
    const double squares = both_tell_errors(in) ? ref * ref + test * test : sum * sum;
    return (struct noise){sum, in->replicates > 1 ? squares / (in->replicates - 1) : 0};
}

// What the test of pixels takes; `all`: the noise of both pictures.
static struct noise noise_of_pixel(const struct ztest_input *in, double single,
                                   const struct noise *all) {
    const bool noisy_ref = in->pixels_of_noisy_ref || both_tell_errors(in);
    const double scale = 1 / in->samples + (noisy_ref ? 1 / in->ref_samples : 0);
    struct noise n = both_tell_errors(in) ? *all : noise_of(in, 0, single * scale);
    n.variance = fmax(n.variance, smallest_variance * scale);
    return n;
}

static void add_pixel(const struct ztest_input *in, size_t p, struct ztest_level *pixels,
                      struct sums *s) {
    double ref[3], test[3], single[3], ref_own[3], test_own[3];
    to_xyz(in->ref->pixels + 3 * p, ref);
    to_xyz(in->test->pixels + 3 * p, test);
    (in->variance_of_rgb ? rgb_variance_to_xyz : to_xyz)(in->variance->pixels + 3 * p, single);
    if (in->ref_variance)
        rgb_variance_to_xyz(in->ref_variance->pixels + 3 * p, ref_own);
    if (in->test_variance)
        rgb_variance_to_xyz(in->test_variance->pixels + 3 * p, test_own);
    for (int i = 0; i < 3; i++) {
        const double d = test[i] - ref[i];
        const struct noise all =
            noise_of(in, in->ref_variance ? ref_own[i] : single[i] / in->ref_samples,
                     in->test_variance ? test_own[i] : single[i] / in->samples);
        const struct noise n = noise_of_pixel(in, single[i], &all);
        count_value(pixels, d / sqrt(n.variance), degrees_of(&n));
        s->ref[i] += ref[i];
        s->difference[i] += d;
        s->noise[i].variance += all.variance;
        s->noise[i].spread += all.spread;
    }
}

// Rounding of pictures that were summed up in float does not average out over a flat area: a random
// walk over the samples is allowed for, at least 16 ulp.
static double rounding_error(const struct ztest_input *in) {
    const double steps = isfinite(in->ref_samples) ? sqrt(in->ref_samples) : 0;
    return (double)FLT_EPSILON * fmax(16, steps);
}

static double z_of_sum(const struct ztest_input *in, const struct sums *s, int i) {
    const double rounding = rounding_error(in) * s->ref[i];
    const double error = sqrt(fmax(s->noise[i].variance, 0) + rounding * rounding);
    return error > 0 ? s->difference[i] / error : s->difference[i] == 0 ? 0 : INFINITY;
}

static void add_block(const struct ztest_input *in, int x0, int y0, struct ztest_result *out,
                      struct sums *all) {
    struct sums s = {{0}};
    for (int y = y0; y < y0 + BLOCK && y < in->ref->height; y++)
        for (int x = x0; x < x0 + BLOCK && x < in->ref->width; x++)
            add_pixel(in, (size_t)y * (size_t)in->ref->width + (size_t)x, &out->pixels, &s);
    for (int i = 0; i < 3; i++) {
        count_value(&out->blocks, z_of_sum(in, &s, i), degrees_of(&s.noise[i]));
        all->ref[i] += s.ref[i];
        all->difference[i] += s.difference[i];
        all->noise[i].variance += s.noise[i].variance;
        all->noise[i].spread += s.noise[i].spread;
    }
}

void ztest_run(const struct ztest_input *in, struct ztest_result *out) {
    const size_t w = (size_t)in->ref->width, h = (size_t)in->ref->height;
    const size_t blocks = ((w + BLOCK - 1) / BLOCK) * ((h + BLOCK - 1) / BLOCK);
    struct sums all = {{0}};
    *out = (struct ztest_result){0};
    start_level(&out->pixels, w * h);
    start_level(&out->blocks, 3 * blocks);
    start_level(&out->mean, 3);
    for (int y = 0; y < in->ref->height; y += BLOCK)
        for (int x = 0; x < in->ref->width; x += BLOCK)
            add_block(in, x, y, out, &all);
    for (int i = 0; i < 3; i++)
        count_value(&out->mean, z_of_sum(in, &all, i), degrees_of(&all.noise[i]));
    finish_level(&out->pixels);
    finish_level(&out->blocks);
    finish_level(&out->mean);
    out->relative_difference = all.difference[1] / all.ref[1];
    out->relative_error = sqrt(fmax(all.noise[1].variance, 0)) / fabs(all.ref[1]);
    out->pass = out->pixels.pass && out->blocks.pass && out->mean.pass;
}
