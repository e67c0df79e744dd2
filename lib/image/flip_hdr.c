// SPDX-License-Identifier: Apache-2.0
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/flip.h"

// ACES tone curve (Narkowicz 2015) with its exposure factor 0.6 undone, as flip-evaluator has it:
// (a x^2 + b x) / (d x^2 + e x + f).
static const float A = 0.6f * 0.6f * 2.51f, B = 0.6f * 0.03f;
static const float D = 0.6f * 0.6f * 2.43f, E = 0.6f * 0.59f, F = 0.14f;

static float aces(float x) {
    if (!(x > 0))
        return 0;
    if (x > 1e15f) // its square would be infinite; the curve's limit is A / D > 1
        return 1;
    return fminf((x * (A * x + B)) / (x * (D * x + E) + F), 1);
}

static int compare_floats(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

struct flip_exposures flip_find_exposures(const struct image *ref) {
    // Where the curve reaches 0.85: the larger root of (A - t D) x^2 + (B - t E) x - t F = 0.
    const double t = 0.85, a = A - t * D, b = B - t * E, c = -t * F;
    const double x = (-b + sqrt(b * b - 4 * a * c)) / (2 * a);
    const size_t count = (size_t)ref->width * (size_t)ref->height;
    float *luminance = mem_array(count, sizeof *luminance);
    size_t n = 0;
    for (size_t p = 0; p < count; p++) {
        const float *v = ref->pixels + 3 * p;
        const float y = 0.2126f * v[0] + 0.7152f * v[1] + 0.0722f * v[2];
        if (isfinite(y))
            luminance[n++] = y;
    }
    qsort(luminance, n, sizeof *luminance, compare_floats);
    struct flip_exposures e = {0, 0, 2};
    if (n > 0 && luminance[n - 1] > 0) {
        const float median = luminance[n / 2];
        e.start = log2(x / (double)luminance[n - 1]);
        e.stop = log2(x / (double)fmaxf(median, FLT_EPSILON));
        e.stop = fmax(e.stop, e.start);
        e.count = (int)fmax(2, ceil(e.stop - e.start));
    }
    mem_free(luminance);
    return e;
}

static void expose(const struct image *in, double stops, struct image *out) {
    const size_t n = 3 * (size_t)in->width * (size_t)in->height;
    const float gain = (float)exp2(stops);
    for (size_t i = 0; i < n; i++)
        out->pixels[i] = aces(in->pixels[i] * gain);
}

double flip_hdr(const struct image *ref, const struct image *test,
                const struct flip_exposures *exposures, double pixels_per_degree, int threads,
                struct image *map) {
    const size_t count = (size_t)ref->width * (size_t)ref->height;
    struct image shown[2] = {{0}}, one = {0};
    float *largest = mem_array(count, sizeof *largest);
    const int steps = exposures->count > 1 ? exposures->count - 1 : 1;
    const double step = (exposures->stop - exposures->start) / steps;
    bool good = image_init(&shown[0], ref->width, ref->height, 3) &&
                image_init(&shown[1], ref->width, ref->height, 3);
    for (int i = 0; i < exposures->count && good; i++) {
        expose(ref, exposures->start + i * step, &shown[0]);
        expose(test, exposures->start + i * step, &shown[1]);
        flip_ldr(&shown[0], &shown[1], pixels_per_degree, threads, &one);
        for (size_t p = 0; p < count; p++)
            largest[p] = fmaxf(largest[p], one.pixels[p]);
        image_finish(&one);
    }
    double sum = 0;
    for (size_t p = 0; p < count; p++)
        sum += (double)largest[p];
    if (map && image_init(map, ref->width, ref->height, 1))
        memcpy(map->pixels, largest, count * sizeof *largest);
    mem_free(largest);
    image_finish(&shown[0]);
    image_finish(&shown[1]);
    return sum / (double)count;
}

// Polynomials of degree 6 through matplotlib's magma (M. Zucker, CC0), within 0.01 of it.
void flip_magma(float v, float rgb[3]) {
    static const float c[7][3] = {
        {-0.002136485f, -0.000749655f, -0.005386128f}, {0.251660541f, 0.677523244f, 2.494026599f},
        {8.353717279f, -3.577719515f, 0.314467903f},   {-27.668733086f, 14.264730781f, -13.649213188f},
        {52.176139812f, -27.943606072f, 12.944169442f}, {-50.768525365f, 29.046582821f, 4.234152994f},
        {18.655705066f, -11.489773520f, -5.601961509f}};
    const float t = v > 0 ? fminf(v, 1) : 0;
    for (int i = 0; i < 3; i++) {
        float sum = c[6][i];
        for (int k = 5; k >= 0; k--)
            sum = sum * t + c[k][i];
        rgb[i] = fminf(fmaxf(sum, 0), 1);
    }
}
