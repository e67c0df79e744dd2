// SPDX-License-Identifier: Apache-2.0
#include "image/metrics.h"

#include <math.h>

float metrics_display(float v, float gain) {
    const float x = v * gain;
    return x > 0 ? linear_to_srgb(x < 1 ? x : 1) : 0; // NaN: 0
}

// Sums over values of squared errors and of their variance under Gaussian noise of variance s2:
// (d + n)^2 with n ~ N(0, s2) has the variance 4 d^2 s2 + 2 s2^2, and the expectation of the
// measured e^2 is d^2 + s2; so 4 e^2 s2 - 2 s2^2 estimates it. Its sum is below 0 where the s2 are
// badly known themselves, or where the pictures share their noise: then it tells nothing.
struct squares {
    double sum, variance, noise;
};

static void add_square(struct squares *q, double e, double s2, double weight) {
    q->sum += weight * e * e;
    q->variance += weight * weight * (4 * e * e * s2 - 2 * s2 * s2);
    q->noise += weight * s2;
}

static struct estimate finish_squares(const struct squares *q, double n, bool known) {
    return (struct estimate){q->sum / n, known && q->variance >= 0 ? sqrt(q->variance) / n : NAN};
}

struct sums {
    struct squares absolute, relative, shown;
    double ref, test, ref_variance, test_variance;
    size_t count;
};

static double variance_at(const struct image *variance, size_t i) {
    const float v = variance ? variance->pixels[i] : 0;
    return v > 0 && isfinite(v) ? (double)v : 0;
}

static double mean_of_finite(const struct image *im) {
    const size_t n = 3 * (size_t)im->width * (size_t)im->height;
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        if (isfinite(im->pixels[i]))
            sum += (double)im->pixels[i], count++;
    return count ? sum / (double)count : 0;
}

// Variance of a displayed value: the slope of the display curve over +- one standard error.
static double shown_variance(double v, double s2, float gain) {
    const double s = sqrt(s2);
    const double slope = (double)metrics_display((float)(v + s), gain) -
                         (double)metrics_display((float)(v - s), gain);
    return slope * slope / 4;
}

static void add_value(const struct metrics_input *in, size_t i, float gain, double eps,
                      struct sums *s) {
    const double a = (double)in->test->pixels[i], b = (double)in->ref->pixels[i];
    const double va = variance_at(in->test_variance, i), vb = variance_at(in->ref_variance, i);
    const double shown = (double)metrics_display((float)a, gain) -
                         (double)metrics_display((float)b, gain);
    const double scale = b * b + eps;
    add_square(&s->absolute, a - b, va + vb, 1);
    add_square(&s->relative, a - b, va + vb, scale > 0 ? 1 / scale : 0);
    add_square(&s->shown, shown, shown_variance(a, va, gain) + shown_variance(b, vb, gain), 1);
    s->test += a;
    s->ref += b;
    s->test_variance += va;
    s->ref_variance += vb;
    s->count++;
}

static struct estimate ratio_of_means(const struct sums *s, bool known) {
    const double ratio = s->test / s->ref;
    const double relative =
        s->test_variance / (s->test * s->test) + s->ref_variance / (s->ref * s->ref);
    return (struct estimate){ratio, known ? fabs(ratio) * sqrt(relative) : NAN};
}

void metrics_measure(const struct metrics_input *in, struct metrics *out) {
    const size_t n = 3 * (size_t)in->ref->width * (size_t)in->ref->height;
    const bool known = in->ref_variance || in->test_variance;
    const float gain = (float)exp2(in->exposure);
    const double mean = mean_of_finite(in->ref);
    const double eps = in->eps >= 0 ? in->eps : 1e-3 * mean * mean;
    struct sums s = {{0}};
    for (size_t i = 0; i < n; i++)
        if (isfinite(in->ref->pixels[i]) && isfinite(in->test->pixels[i]))
            add_value(in, i, gain, eps, &s);
    const double count = (double)s.count;
    const struct estimate shown = finish_squares(&s.shown, count, known);
    *out = (struct metrics){
        .mean_ratio = ratio_of_means(&s, known),
        .mse = finish_squares(&s.absolute, count, known),
        .relmse = finish_squares(&s.relative, count, known),
        .psnr = {-10 * log10(shown.value), 10 / log(10) * shown.error / shown.value},
        .ssim = {NAN, NAN},
        .mse_noise = known ? s.absolute.noise / count : NAN,
        .relmse_noise = known ? s.relative.noise / count : NAN,
        .eps = eps,
        .left_out = n - s.count,
    };
}
