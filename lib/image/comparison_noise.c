// SPDX-License-Identifier: Apache-2.0
#include "image/comparison_noise.h"

#include <math.h>
#include <string.h>

#include "math/hash.h"

enum { REPLICATES = 8 };

// The display-referred picture that LDR-FLIP sees: exposed; it clips.
static double flip_shown(const struct metrics_input *in, double pixels_per_degree) {
    struct image shown[2];
    const struct image *pictures[2] = {in->ref, in->test};
    const float gain = (float)exp2(in->exposure);
    const size_t n = 3 * (size_t)in->ref->width * (size_t)in->ref->height;
    for (int k = 0; k < 2; k++) {
        if (!image_init(&shown[k], in->ref->width, in->ref->height, 3))
            return NAN;
        for (size_t i = 0; i < n; i++)
            shown[k].pixels[i] = pictures[k]->pixels[i] * gain;
    }
    const double mean = flip_ldr(&shown[0], &shown[1], pixels_per_degree, in->threads, NULL);
    image_finish(&shown[0]);
    image_finish(&shown[1]);
    return mean;
}

static struct perceived measure_at(const struct metrics_input *in, double pixels_per_degree,
                                   const struct flip_exposures *exposures, struct image *map) {
    return (struct perceived){
        .ssim = ssim_measure(in->ref, in->test, in->exposure, in->threads),
        .flip_ldr = flip_shown(in, pixels_per_degree),
        .flip_hdr = flip_hdr(in->ref, in->test, exposures, pixels_per_degree, in->threads, map),
    };
}

struct perceived perceived_measure(const struct metrics_input *in, double pixels_per_degree,
                                   struct flip_exposures *exposures, struct image *map) {
    *exposures = flip_find_exposures(in->ref);
    return measure_at(in, pixels_per_degree, exposures, map);
}

// Standard normal number i of stream `stream` (Box and Muller 1958).
static double normal(uint64_t stream, uint64_t i) {
    const uint64_t h = hash_u64(hash_u64(i) + stream);
    const double u = ((double)(h >> 32) + 0.5) * 0x1p-32;
    const double v = (double)(h & 0xffffffff) * 0x1p-32;
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

static bool copy_with_noise(const struct image *im, const struct image *variance, uint64_t stream,
                            struct image *out) {
    if (!image_init(out, im->width, im->height, 3))
        return false;
    const size_t n = 3 * (size_t)im->width * (size_t)im->height;
    memcpy(out->pixels, im->pixels, n * sizeof(float));
    for (size_t i = 0; i < n && variance; i++)
        if (variance->pixels[i] > 0)
            out->pixels[i] += (float)(sqrt((double)variance->pixels[i]) * normal(stream, i));
    return true;
}

static bool measure_replicate(const struct metrics_input *in, double pixels_per_degree,
                              const struct flip_exposures *exposures, int k,
                              struct perceived *out) {
    struct image ref = {0}, test = {0};
    const bool good = copy_with_noise(in->ref, in->ref_variance, (uint64_t)(2 * k), &ref) &&
                      copy_with_noise(in->test, in->test_variance, (uint64_t)(2 * k + 1), &test);
    if (good) {
        struct metrics_input noisy = *in;
        noisy.ref = &ref;
        noisy.test = &test;
        *out = measure_at(&noisy, pixels_per_degree, exposures, NULL);
    }
    image_finish(&ref);
    image_finish(&test);
    return good;
}

static double spread(const double *values) {
    double mean = 0, squares = 0;
    for (int k = 0; k < REPLICATES; k++)
        mean += values[k] / REPLICATES;
    for (int k = 0; k < REPLICATES; k++)
        squares += (values[k] - mean) * (values[k] - mean);
    return sqrt(squares / (REPLICATES - 1));
}

struct perceived perceived_errors(const struct metrics_input *in, double pixels_per_degree,
                                  const struct flip_exposures *exposures) {
    double ssim[REPLICATES], ldr[REPLICATES], hdr[REPLICATES];
    if (!in->ref_variance && !in->test_variance)
        return (struct perceived){NAN, NAN, NAN};
    for (int k = 0; k < REPLICATES; k++) {
        struct perceived p;
        if (!measure_replicate(in, pixels_per_degree, exposures, k, &p))
            return (struct perceived){NAN, NAN, NAN};
        ssim[k] = p.ssim;
        ldr[k] = p.flip_ldr;
        hdr[k] = p.flip_hdr;
    }
    return (struct perceived){spread(ssim), spread(ldr), spread(hdr)};
}
