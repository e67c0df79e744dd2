// SPDX-License-Identifier: Apache-2.0
#include "image/metrics.h"

#include <math.h>

float metrics_display(float v, float gain) {
    const float x = v * gain;
    return x > 0 ? linear_to_srgb(x < 1 ? x : 1) : 0; // NaN: 0
}

// Sums over values of squared errors and of what noise of variance s2 makes of them: with n ~ N(0, s2),
// (d + n)^2 has the variance 4 d^2 s2 + 2 s2^2, and the expectation of the measured e^2 is d^2 + s2.
struct squares {
    double sum, noise;
    double product, noise2; // sums of e^2 s2 and of s2^2
    double noise4;
};

static void add_square(struct squares *q, double e, double s2, double weight) {
    const double e2 = weight * e * e, w2 = weight * s2;
    q->sum += e2;
    q->noise += w2;
    q->product += e2 * w2;
    q->noise2 += w2 * w2;
    q->noise4 += w2 * w2 * w2 * w2;
}

// Whether the noise tells nothing: the pictures are equal and share it, or their squared errors are less
// than half of what it makes of equal ones, by more than 4 standard errors sqrt(2 noise4) of that, so
// that it is not what it is said to be. Noise that a few values have nearly all of may be that far off.
static bool is_impossible(const struct squares *q) {
    return q->product < 0.5 * q->noise2 &&
           (q->sum == 0 || q->noise2 - q->product > 4 * sqrt(2 * q->noise4));
}

// product - noise2 estimates the sum of d^2 s2, which is not negative. Where it came out so, by chance,
// the pictures are equal as far as the noise tells.
static struct estimate finish_squares(const struct squares *q, double n, bool known) {
    const double variance = 4 * fmax(q->product - q->noise2, 0) + 2 * q->noise2;
    return (struct estimate){q->sum / n, known && !is_impossible(q) ? sqrt(variance) / n : NAN};
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
