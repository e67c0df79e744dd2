// SPDX-License-Identifier: Apache-2.0
// Metrics against closed forms, scikit-image (SSIM), and the errors they claim against the spread
// of repeated noise.
#include "check.h"

#include <string.h>

#include "image/metrics.h"
#include "math/hash.h"
#include "picture_pairs.h"

static void fill(struct image *im, int width, int height, float value) {
    CHECK(image_init(im, width, height, 3));
    for (int i = 0; i < 3 * width * height; i++)
        im->pixels[i] = value;
}

static void constants_have_closed_forms(void) {
    struct image ref, test;
    struct metrics m;
    fill(&ref, 20, 15, 0.5f);
    fill(&test, 20, 15, 0.625f);
    const struct metrics_input in = {.ref = &ref, .test = &test, .eps = -1};
    metrics_measure(&in, &m);
    CHECK_NEAR(m.mean_ratio.value, 1.25, 1e-12);
    CHECK_NEAR(m.mse.value, 0.125 * 0.125, 1e-12);
    CHECK_NEAR(m.eps, 1e-3 * 0.25, 1e-12);
    CHECK_NEAR(m.relmse.value, 0.015625 / 0.25025, 1e-12);
    CHECK(isnan(m.mse.error) && isnan(m.mean_ratio.error) && isnan(m.mse_noise));
    struct metrics_input absolute = in;
    absolute.eps = 0.1;
    metrics_measure(&absolute, &m);
    CHECK_NEAR(m.relmse.value, 0.015625 / 0.35, 1e-12);
    image_finish(&ref);
    image_finish(&test);
}

// Scaling both pictures leaves relMSE as it is, from 1e-15 to 1e15.
static void relmse_knows_no_exposure(void) {
    struct image ref, test;
    struct metrics m;
    make_hdr_pair(&ref, &test);
    const struct metrics_input in = {.ref = &ref, .test = &test, .eps = -1};
    metrics_measure(&in, &m);
    const double expected = m.relmse.value;
    for (int k = 0; k < 2; k++) {
        const float scale = k ? 0x1p+50f : 0x1p-100f;
        for (int i = 0; i < 3 * PAIR_WIDTH * PAIR_HEIGHT; i++) {
            ref.pixels[i] *= scale;
            test.pixels[i] *= scale;
        }
        metrics_measure(&in, &m);
        CHECK_NEAR(m.relmse.value / expected, 1, 1e-6);
    }
    image_finish(&ref);
    image_finish(&test);
}

// 0.1 between the displayed values: 20 dB; at another exposure the same two values shown.
static void psnr_is_of_the_displayed_picture(void) {
    struct image ref, test;
    struct metrics m;
    fill(&ref, 4, 4, srgb_to_linear(0.5f));
    fill(&test, 4, 4, srgb_to_linear(0.6f));
    struct metrics_input in = {.ref = &ref, .test = &test, .eps = -1};
    metrics_measure(&in, &m);
    CHECK_NEAR(m.psnr.value, 20, 1e-4);
    in.exposure = 10; // both burn out
    metrics_measure(&in, &m);
    CHECK(isinf(m.psnr.value) && m.psnr.value > 0);
    image_finish(&ref);
    image_finish(&test);
}

static void ssim_is_that_of_wang_2004(void) {
    struct image ref, test;
    make_ldr_pair(&ref, &test);
    CHECK_NEAR(ssim_measure(&ref, &ref, 0, 2), 1, 1e-12);
    // scikit-image 0.26.0: structural_similarity(gaussian_weights=True, sigma=1.5,
    // use_sample_covariance=False, data_range=1) of the sRGB-encoded luminances.
    CHECK_NEAR(ssim_measure(&ref, &test, 0, 1), 0.5939305357, 1e-5);
    CHECK(ssim_measure(&ref, &test, 0, 1) == ssim_measure(&ref, &test, 0, 7));
    image_finish(&ref);
    image_finish(&test);
    const float a = 0.3f, b = 0.7f; // flat: the luminance term alone; in a window of 1 and of 9
    const double expected = (2 * a * b + 1e-4) / (a * a + b * b + 1e-4);
    for (int size = 1; size <= 30; size += 8) {
        fill(&ref, size, 31 - size, srgb_to_linear(a));
        fill(&test, size, 31 - size, srgb_to_linear(b));
        CHECK_NEAR(ssim_measure(&ref, &test, 0, 1), expected, 1e-4);
        image_finish(&ref);
        image_finish(&test);
    }
}

static void odd_values_are_left_out_and_counted(void) {
    struct image ref, test;
    struct metrics m;
    fill(&ref, 10, 10, 1);
    fill(&test, 10, 10, 1);
    test.pixels[5] = NAN;
    test.pixels[6] = INFINITY;
    ref.pixels[6] = -INFINITY;
    ref.pixels[7] = 1e30f;
    test.pixels[7] = 1e30f;
    metrics_measure(&(struct metrics_input){.ref = &ref, .test = &test, .eps = -1}, &m);
    CHECK(m.left_out == 2);
    CHECK(m.mse.value == 0 && m.relmse.value == 0 && m.mean_ratio.value == 1);
    image_finish(&ref);
    image_finish(&test);
}

static double normal(struct rng *r) {
    const double u = ((double)rng_u32(r) + 0.5) * 0x1p-32, v = (double)rng_u32(r) * 0x1p-32;
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

// mean, MSE, relMSE and PSNR of a biased picture with fresh noise, RUNS times: the claimed standard
// error must be the spread found. The spread's own relative error is 1 / sqrt(2 RUNS) = 2.2 %; 5 of
// them on each side: false alarms below 1e-5 for all four together, with 3 % for non-normality.
static void claimed_errors_are_the_spread_of_repeats(void) {
    enum { RUNS = 1000, SIZE = 24, N = 3 * SIZE * SIZE };
    struct image ref, test, variance;
    struct rng r = {1};
    double sum[4] = {0}, squares[4] = {0}, claimed[4] = {0}, noise = 0;
    fill(&ref, SIZE, SIZE, 0);
    fill(&test, SIZE, SIZE, 0);
    fill(&variance, SIZE, SIZE, 0);
    for (int i = 0; i < N; i++) {
        ref.pixels[i] = 0.2f + 0.6f * rng_float(&r);
        variance.pixels[i] = 1e-3f * rng_float(&r);
    }
    for (int run = 0; run < RUNS; run++) {
        struct metrics m;
        for (int i = 0; i < N; i++)
            test.pixels[i] = ref.pixels[i] * 1.02f +
                             (float)(sqrt((double)variance.pixels[i]) * normal(&r));
        metrics_measure(&(struct metrics_input){.ref = &ref, .test = &test,
                                                .test_variance = &variance, .eps = -1}, &m);
        const struct estimate e[4] = {m.mean_ratio, m.mse, m.relmse, m.psnr};
        for (int k = 0; k < 4; k++) {
            sum[k] += e[k].value;
            squares[k] += e[k].value * e[k].value;
            claimed[k] += e[k].error / RUNS;
        }
        noise = m.mse_noise;
    }
    double bias = 0;
    for (int i = 0; i < N; i++)
        bias += 4e-4 * (double)ref.pixels[i] * (double)ref.pixels[i] / N;
    for (int k = 0; k < 4; k++) {
        const double mean = sum[k] / RUNS;
        const double spread = sqrt((squares[k] - RUNS * mean * mean) / (RUNS - 1));
        CHECK_NEAR(claimed[k] / spread, 1, 0.14);
    }
    CHECK_NEAR(sum[0] / RUNS, 1.02, 5 * claimed[0] / sqrt(RUNS));
    CHECK_NEAR(sum[1] / RUNS, bias + noise, 5 * claimed[1] / sqrt(RUNS)); // 5 sigma: 6e-7
    image_finish(&ref);
    image_finish(&test);
    image_finish(&variance);
}

// Squared errors of less than half the variance: the noise cannot be what it is said to be, and what
// it leaves of the errors is not known. No noise at all leaves all of them.
static void impossible_noise_has_no_interval(void) {
    struct image ref, test, variance;
    struct metrics m;
    fill(&ref, 8, 8, 0.5f);
    fill(&test, 8, 8, 0.51f);
    fill(&variance, 8, 8, 0.01f);
    const struct metrics_input in = {.ref = &ref, .test = &test, .test_variance = &variance,
                                     .eps = -1};
    metrics_measure(&in, &m);
    CHECK(isnan(m.mse.error) && isnan(m.relmse.error) && isnan(m.psnr.error));
    CHECK_NEAR(m.mse_noise, 0.01, 1e-8);
    CHECK(m.mean_ratio.error > 0);
    image_finish(&variance);
    fill(&variance, 8, 8, 0);
    metrics_measure(&in, &m);
    CHECK(m.mse.error == 0 && m.relmse.error == 0 && m.psnr.error == 0);
    image_finish(&ref);
    image_finish(&test);
    image_finish(&variance);
}

// Pure noise, nearly all of it in one value of 192, as after a rare bright sample: an interval is told
// whatever that value came out as. It holds the expected MSE unless the deviate is beyond 4.1, so that
// it is too wide rather than too narrow: of 2000 pictures more than 95 %.
static void noise_of_one_value_has_an_interval(void) {
    enum { RUNS = 2000, N = 3 * 8 * 8 };
    struct image ref, test, variance;
    struct rng r = {2};
    int within = 0;
    fill(&ref, 8, 8, 0.5f);
    fill(&test, 8, 8, 0);
    fill(&variance, 8, 8, 1e-8f);
    variance.pixels[50] = 1;
    for (int run = 0; run < RUNS; run++) {
        struct metrics m;
        for (int i = 0; i < N; i++)
            test.pixels[i] = ref.pixels[i] +
                             (float)(sqrt((double)variance.pixels[i]) * normal(&r));
        metrics_measure(&(struct metrics_input){.ref = &ref, .test = &test,
                                                .test_variance = &variance, .eps = -1}, &m);
        CHECK(m.mse.error > 0 && m.relmse.error > 0);
        within += fabs(m.mse.value - m.mse_noise) < 1.96 * m.mse.error;
    }
    CHECK(within > 0.95 * RUNS);
    image_finish(&ref);
    image_finish(&test);
    image_finish(&variance);
}

int main(void) {
    constants_have_closed_forms();
    relmse_knows_no_exposure();
    psnr_is_of_the_displayed_picture();
    ssim_is_that_of_wang_2004();
    odd_values_are_left_out_and_counted();
    claimed_errors_are_the_spread_of_repeats();
    impossible_noise_has_no_interval();
    noise_of_one_value_has_an_interval();
    return check_result();
}
