// SPDX-License-Identifier: Apache-2.0
// The z-test raises as many false alarms as it says, and finds what it should.
#include "check.h"

#include "image/ztest.h"
#include "math/hash.h"

static double normal(struct rng *r) {
    const double u = ((double)rng_u32(r) + 0.5) * 0x1p-32, v = (double)rng_u32(r) * 0x1p-32;
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

// Linear Rec.709 of a CIE XYZ colour: the inverse of the matrix in ztest.c.
static void to_rgb(const double xyz[3], float rgb[3]) {
    rgb[0] = (float)(3.240479 * xyz[0] - 1.537150 * xyz[1] - 0.498535 * xyz[2]);
    rgb[1] = (float)(-0.969256 * xyz[0] + 1.875991 * xyz[1] + 0.041556 * xyz[2]);
    rgb[2] = (float)(0.055648 * xyz[0] - 0.204043 * xyz[1] + 1.057311 * xyz[2]);
}

struct pictures {
    struct image ref, test, variance;
};

enum { SAMPLES = 64, REF_SAMPLES = 256 };

// Truth 1 in X, Y and Z, single-sample variances between 0.5 and 1.5; both pictures get the noise
// of their samples, and the test a relative bias.
static void make_pictures(struct pictures *p, int width, int height, double bias, bool noisy_ref,
                          struct rng *r) {
    CHECK(image_init(&p->ref, width, height, 3) && image_init(&p->test, width, height, 3) &&
          image_init(&p->variance, width, height, 3));
    for (int i = 0; i < width * height; i++) {
        double ref[3], test[3], variance[3];
        for (int c = 0; c < 3; c++) {
            variance[c] = 0.5 + (double)rng_float(r);
            ref[c] = 1 + (noisy_ref ? sqrt(variance[c] / REF_SAMPLES) * normal(r) : 0);
            test[c] = 1 + bias + sqrt(variance[c] / SAMPLES) * normal(r);
        }
        to_rgb(ref, p->ref.pixels + 3 * i);
        to_rgb(test, p->test.pixels + 3 * i);
        to_rgb(variance, p->variance.pixels + 3 * i);
    }
}

static void run(int width, int height, double bias, bool noisy_ref, struct rng *r,
                struct ztest_result *out) {
    struct pictures p;
    make_pictures(&p, width, height, bias, noisy_ref, r);
    const struct ztest_input in = {.ref = &p.ref, .test = &p.test, .variance = &p.variance,
                                   .samples = SAMPLES,
                                   .ref_samples = noisy_ref ? REF_SAMPLES : INFINITY};
    ztest_run(&in, out);
    image_finish(&p.ref);
    image_finish(&p.test);
    image_finish(&p.variance);
}

// Pictures of one pixel: each of 3 values disagrees with probability 0.01. 60 000 values: 600 +-
// 24.4; 5 standard deviations: false alarm 6e-7.
static void single_values_disagree_once_in_a_hundred(void) {
    struct rng r = {2};
    double disagree = 0;
    for (int i = 0; i < 20000; i++) {
        struct ztest_result z;
        run(1, 1, 0, false, &r, &z);
        CHECK(z.pixels.values == 3);
        disagree += (double)(z.pixels.values - z.pixels.agreeing);
    }
    CHECK_NEAR(disagree, 600, 5 * 24.4);
}

// Block and picture means, with the noise of both pictures: each picture fails with probability
// 0.01 by each. 4000 pictures: 40 +- 6.3; 5 standard deviations.
static void means_disagree_once_in_a_hundred(void) {
    struct rng r = {3};
    int blocks = 0, means = 0, pixels = 0;
    for (int i = 0; i < 4000; i++) {
        struct ztest_result z;
        run(17, 9, 0, true, &r, &z); // blocks that the size cuts off too
        CHECK(z.blocks.values == 3 * 3 * 2 && z.mean.values == 3);
        blocks += z.blocks.agreeing < z.blocks.values;
        means += z.mean.agreeing < z.mean.values;
    }
    for (int i = 0; i < 200; i++) {
        struct ztest_result z;
        run(40, 40, 0, false, &r, &z);
        pixels += !z.pixels.pass; // needs 13 of 4800 values, where 0.03 are expected
    }
    CHECK_NEAR(blocks, 40, 5 * 6.3);
    CHECK_NEAR(means, 40, 5 * 6.3);
    CHECK(pixels == 0);
}

// A bias of 2 %: 0.16 standard errors of a pixel, 6.4 of the mean of 1600 of them (variance 1).
static void a_small_uniform_bias_shows_in_the_mean_alone(void) {
    struct rng r = {4};
    struct ztest_result z;
    run(40, 40, 0.02, true, &r, &z);
    CHECK(z.pixels.pass && !z.mean.pass && !z.pass);
    CHECK_NEAR(z.relative_difference, 0.02, 5 * z.relative_error);
    CHECK_NEAR(z.relative_error, sqrt((1. / SAMPLES + 1. / REF_SAMPLES) / 1600), 5e-4);
    run(40, 40, 0, true, &r, &z);
    CHECK(z.mean.largest_z < 5);
}

static void a_wrong_spot_shows_in_pixels_and_blocks(void) {
    struct rng r = {5};
    struct pictures p;
    struct ztest_result z;
    make_pictures(&p, 64, 64, 0, false, &r);
    for (int y = 3; y < 10; y++)
        for (int x = 5; x < 12; x++)
            for (int c = 0; c < 3; c++)
                p.test.pixels[3 * (64 * y + x) + c] += 1;
    const struct ztest_input in = {.ref = &p.ref, .test = &p.test, .variance = &p.variance,
                                   .samples = SAMPLES, .ref_samples = INFINITY};
    ztest_run(&in, &z);
    CHECK(!z.pixels.pass && !z.blocks.pass);
    p.test.pixels[0] = NAN; // a value that is no number never agrees
    ztest_run(&in, &z);
    CHECK(isinf(z.pixels.largest_z) && !z.mean.pass);
    image_finish(&p.ref);
    image_finish(&p.test);
    image_finish(&p.variance);
}

// No noise at all: rounding passes, a difference of 1e-4 does not.
static void equal_pictures_without_variance_agree(void) {
    struct pictures p;
    struct ztest_result z;
    struct rng r = {6};
    make_pictures(&p, 16, 16, 0, true, &r);
    for (int i = 0; i < 3 * 256; i++) {
        p.variance.pixels[i] = 0;
        p.test.pixels[i] = nextafterf(p.ref.pixels[i], 2);
    }
    const struct ztest_input in = {.ref = &p.ref, .test = &p.test, .variance = &p.variance,
                                   .samples = SAMPLES, .ref_samples = REF_SAMPLES};
    ztest_run(&in, &z);
    CHECK(z.pass);
    for (int i = 0; i < 3 * 256; i++)
        p.test.pixels[i] = 1.0001f * p.ref.pixels[i];
    ztest_run(&in, &z);
    CHECK(!z.mean.pass && !z.blocks.pass);
    image_finish(&p.ref);
    image_finish(&p.test);
    image_finish(&p.variance);
}

// Red noise of variance 4 in one pixel that differs by 1 in red: z is of red alone in X, Y and Z; the
// noise of a reference of as many samples halves its square.
static void variances_of_rgb_are_of_channels(void) {
    struct image ref, test, variance;
    struct ztest_result z;
    CHECK(image_init(&ref, 1, 1, 3) && image_init(&test, 1, 1, 3) && image_init(&variance, 1, 1, 3));
    test.pixels[0] = 1;
    variance.pixels[0] = 4;
    struct ztest_input in = {.ref = &ref, .test = &test, .variance = &variance,
                             .variance_of_rgb = true, .samples = SAMPLES, .ref_samples = SAMPLES};
    ztest_run(&in, &z);
    CHECK_NEAR(z.pixels.largest_z, sqrt(SAMPLES / 4.), 1e-6);
    CHECK_NEAR(z.mean.largest_z, sqrt(SAMPLES / 8.), 1e-6);
    CHECK_NEAR(z.blocks.largest_z, sqrt(SAMPLES / 8.), 1e-6);
    in.pixels_of_noisy_ref = true;
    ztest_run(&in, &z);
    CHECK_NEAR(z.pixels.largest_z, sqrt(SAMPLES / 8.), 1e-6);
    image_finish(&ref);
    image_finish(&test);
    image_finish(&variance);
}

// One pixel of two pictures: grey, with errors found from so many replicates each, the second's twice
// the first's.
static void tell_pixel(struct pictures *p, struct image *test_variance, int replicates,
                       struct rng *r) {
    for (int k = 0; k < 2; k++) {
        struct image *picture = k ? &p->test : &p->ref, *variance = k ? test_variance : &p->variance;
        double sum = 0, squares = 0;
        for (int i = 0; i < replicates; i++) {
            const double x = (k + 1) * normal(r);
            sum += x;
            squares += x * x;
        }
        const double mean = sum / replicates;
        for (int c = 0; c < 3; c++) {
            picture->pixels[c] = (float)mean;
            variance->pixels[c] = (float)((squares / replicates - mean * mean) / (replicates - 1));
        }
    }
}

// Errors from 5 replicates: 1 % of 40 000 pictures disagree, 400 +- 20, and as many more as Welch's
// degrees of freedom are not exact (6 %); 5 standard deviations. Normal deviates would be 3.7 %.
static void errors_of_few_replicates_make_students_t(void) {
    struct rng r = {7};
    struct pictures p;
    struct image test_variance;
    int disagree = 0;
    CHECK(image_init(&p.ref, 1, 1, 3) && image_init(&p.test, 1, 1, 3) &&
          image_init(&p.variance, 1, 1, 3) && image_init(&test_variance, 1, 1, 3));
    const struct ztest_input in = {.ref = &p.ref, .test = &p.test, .variance = &p.variance,
                                   .variance_of_rgb = true, .samples = 1e9, .ref_samples = 1e9,
                                   .ref_variance = &p.variance, .test_variance = &test_variance,
                                   .replicates = 5};
    for (int i = 0; i < 40000; i++) {
        struct ztest_result z;
        tell_pixel(&p, &test_variance, 5, &r);
        ztest_run(&in, &z);
        disagree += z.pixels.agreeing == 0;
    }
    printf("errors of 5 replicates: %d disagree\n", disagree);
    CHECK_NEAR(disagree, 400, 0.06 * 400 + 5 * 20);
    image_finish(&p.ref);
    image_finish(&p.test);
    image_finish(&p.variance);
    image_finish(&test_variance);
}

int main(void) {
    single_values_disagree_once_in_a_hundred();
    means_disagree_once_in_a_hundred();
    a_small_uniform_bias_shows_in_the_mean_alone();
    a_wrong_spot_shows_in_pixels_and_blocks();
    equal_pictures_without_variance_agree();
    variances_of_rgb_are_of_channels();
    errors_of_few_replicates_make_students_t();
    return check_result();
}
