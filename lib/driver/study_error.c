// SPDX-License-Identifier: Apache-2.0
#include "driver/study_error.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"

static size_t pixels_of(const struct image *im) {
    return (size_t)im->width * (size_t)im->height;
}

static double noise_of(const struct study_reference *ref) {
    const size_t n = 3 * pixels_of(&ref->rgb);
    double sum = 0;
    for (size_t i = 0; ref->variance.pixels && i < n; i++) {
        const double r = (double)ref->rgb.pixels[i], v = (double)ref->variance.pixels[i];
        sum += v > 0 && isfinite(v / (r * r + ref->eps)) ? v / (r * r + ref->eps) : 0;
    }
    return sum / (double)n;
}

bool study_reference_take(struct study_reference *ref, const struct image *im, const char *path) {
    *ref = (struct study_reference){.eps = 0};
    if (!image_to_rgb(im, &ref->rgb) ||
        (image_find_channel(im, "variance.R") >= 0 &&
         !image_layer_to_rgb(im, "variance", path, &ref->variance)))
        return false;
    double sum = 0, luminance = 0;
    size_t count = 0;
    for (size_t p = 0; p < pixels_of(&ref->rgb); p++) {
        const float *v = ref->rgb.pixels + 3 * p;
        if (!isfinite(v[0] + v[1] + v[2]))
            continue;
        sum += (double)v[0] + (double)v[1] + (double)v[2];
        luminance += (double)rgb_luminance(v);
        count++;
    }
    if (!(sum > 0)) {
        log_error("%s: is black: errors relative to it mean nothing", path);
        return false;
    }
    ref->mean = luminance / (double)count;
    ref->eps = 1e-3 * (sum / (3 * (double)count)) * (sum / (3 * (double)count));
    ref->noise = noise_of(ref);
    return true;
}

void study_reference_finish(struct study_reference *ref) {
    image_finish(&ref->rgb);
    image_finish(&ref->variance);
}

// Sums over pixels. A pixel's errors are vectors of three channels, so that its channels need not be
// independent of each other.
struct sums {
    double *gram;
    double noise;    // of the reference: v, the sum over channels of weighted variances
    double square;   // variance of that noise's effect: 4 e v - 4 v^2 + 2 v^2 (1 + 1/15), where e is
                     // the squared mean error, which v itself enlarges, and v has 15 degrees of freedom
    size_t values;
};

static bool all_finite(const struct study_reference *ref, const struct image *runs, int count,
                       size_t p) {
    bool finite = isfinite(ref->rgb.pixels[p]);
    for (int i = 0; i < count; i++)
        finite &= isfinite(runs[i].pixels[p]);
    return finite;
}

static void add_pixel(const struct study_reference *ref, const struct image *runs, int count,
                      size_t pixel, struct sums *s) {
    double e = 0, v = 0;
    for (size_t k = 3 * pixel; k < 3 * pixel + 3; k++) {
        const double r = (double)ref->rgb.pixels[k];
        if (!all_finite(ref, runs, count, k))
            continue;
        const double weight = 1 / (r * r + ref->eps);
        double mean = 0;
        for (int i = 0; i < count; i++) {
            const double a = (double)runs[i].pixels[k] - r;
            mean += a / count;
            for (int j = 0; j <= i; j++)
                s->gram[i * count + j] += weight * a * ((double)runs[j].pixels[k] - r);
        }
        const double variance = ref->variance.pixels ? (double)ref->variance.pixels[k] : 0;
        v += weight * (variance > 0 && isfinite(variance) ? variance : 0);
        e += weight * mean * mean;
        s->values++;
    }
    s->noise += v;
    s->square += 4 * e * v - 4 * v * v + 2 * v * v * (1 + 1.0 / 15);
}

struct repeats study_errors(const struct study_reference *ref, const struct image *runs, int count,
                            double *relmse) {
    struct sums s = {.gram = mem_array((size_t)(count * count), sizeof(double))};
    for (size_t p = 0; p < pixels_of(&ref->rgb); p++)
        add_pixel(ref, runs, count, p, &s);
    const double n = (double)s.values;
    for (int i = 0; i < count; i++)
        for (int j = 0; j <= i; j++)
            s.gram[i * count + j] = s.gram[j * count + i] = s.gram[i * count + j] / n;
    for (int i = 0; i < count; i++)
        relmse[i] = s.gram[i * count + i] - s.noise / n;
    const struct repeats out =
        repeats_measure(s.gram, count, s.noise / n, sqrt(fmax(s.square, 0)) / n);
    mem_free(s.gram);
    return out;
}
