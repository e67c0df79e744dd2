// SPDX-License-Identifier: Apache-2.0
#include "image/comparison.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "image/comparison_noise.h"

const char *const comparison_map_names[] = {"flip", "signed", NULL};

static const double MITSUBA_REF_SAMPLES = 32000; // of the references of Mitsuba 3's render tests

// Of a picture by `relume render --variance` (film.h): its layer comes from the spread of so many.
static const double REPLICATES = 16;

// One picture with what is known of its noise.
struct side {
    const char *path;
    struct image rgb, variance; // variance.pixels == NULL: not known
    double samples;             // per pixel, as the file says; 0: it does not
    bool rendered;              // by `relume render`
    bool one_sample;            // has a layer `variance` of one sample: not taken
};

static void finish_side(struct side *s) {
    image_finish(&s->rgb);
    image_finish(&s->variance);
}

static double read_count(const struct image *im, const char *attribute) {
    const struct image_attribute *a = image_find_attribute(im, attribute);
    return a && !a->text && a->number > 0 && isfinite(a->number) ? a->number : 0;
}

static bool read_side(const char *path, struct side *s) {
    struct image im;
    *s = (struct side){.path = path};
    if (!image_read(path, &im))
        return false;
    s->samples = read_count(&im, "relume.samples");
    s->rendered = s->samples > 0;
    if (!s->rendered) // other renderers
        s->samples = read_count(&im, "samples");
    bool good = image_to_rgb(&im, &s->rgb);
    if (good && image_find_channel(&im, "variance.R") >= 0) {
        s->one_sample = s->samples == 1;
        if (s->one_sample)
            log_warn("%s: its layer variance is of one sample per pixel and tells nothing", path);
        else
            good = image_layer_to_rgb(&im, "variance", path, &s->variance);
    }
    image_finish(&im);
    return good;
}

static void replace(struct image *old, struct image *new) {
    image_finish(old);
    *old = *new;
}

// Means over boxes; a mean's squared standard error is the mean of the squares over their number.
static bool downsample_side(struct side *s, int factor) {
    struct image small;
    if (!image_downsample(&s->rgb, factor, &small))
        return false;
    replace(&s->rgb, &small);
    s->samples *= (double)factor * factor;
    if (!s->variance.pixels)
        return true;
    if (!image_downsample(&s->variance, factor, &small))
        return false;
    replace(&s->variance, &small);
    const size_t n = 3 * (size_t)small.width * (size_t)small.height;
    for (size_t i = 0; i < n; i++)
        s->variance.pixels[i] /= (float)(factor * factor);
    return true;
}

static bool same_size(const struct image *a, const struct image *b) {
    return a->width == b->width && a->height == b->height;
}

static bool is_larger(const struct image *a, const struct image *b, int factor) {
    return (a->width + factor - 1) / factor == b->width &&
           (a->height + factor - 1) / factor == b->height;
}

static bool downsample(struct side *ref, struct side *test, int factor) {
    if (factor <= 1)
        return true;
    const bool ref_only = !same_size(&ref->rgb, &test->rgb) &&
                          is_larger(&ref->rgb, &test->rgb, factor);
    const bool test_only = !same_size(&ref->rgb, &test->rgb) &&
                           is_larger(&test->rgb, &ref->rgb, factor);
    return (test_only || downsample_side(ref, factor)) &&
           (ref_only || downsample_side(test, factor));
}

static bool cut(struct image *im, int x, int y, int width, int height) {
    struct image part;
    if (!im->pixels)
        return true;
    if (!image_init(&part, width, height, 3))
        return false;
    for (int row = 0; row < height; row++)
        memcpy(part.pixels + (size_t)row * width * 3,
               im->pixels + ((size_t)(y + row) * im->width + x) * 3,
               (size_t)width * 3 * sizeof(float));
    replace(im, &part);
    return true;
}

// Where one picture is a crop of a picture of the other's size, the other is cut likewise.
static bool cut_to(const struct side *crop, struct side *full) {
    const struct image *c = &crop->rgb;
    const int x = c->crop_x, y = c->crop_y, width = c->width, height = c->height;
    if (c->full_width != full->rgb.width || c->full_height != full->rgb.height || x < 0 || y < 0 ||
        x + width > full->rgb.width || y + height > full->rgb.height)
        return true;
    return cut(&full->rgb, x, y, width, height) && cut(&full->variance, x, y, width, height);
}

static bool match_sizes(const struct comparison_request *request, struct side *ref,
                        struct side *test) {
    if (!downsample(ref, test, request->downsample))
        return false;
    if (!same_size(&ref->rgb, &test->rgb) && (!cut_to(test, ref) || !cut_to(ref, test)))
        return false;
    if (same_size(&ref->rgb, &test->rgb))
        return true;
    log_error("%s: is %d x %d pixels, expected %d x %d as %s%s", test->path, test->rgb.width,
              test->rgb.height, ref->rgb.width, ref->rgb.height, ref->path,
              request->downsample > 1 ? " after downsampling" : "");
    return false;
}

// The variance of single-sample estimates into v->rgb: what a file holds as its picture, or its layer
// `variance`, squared standard errors of the means of all samples, times their number.
static bool read_single_variance(const struct comparison_request *request, struct side *v,
                                 bool *of_layer) {
    if (!read_side(request->variance, v))
        return false;
    *of_layer = v->variance.pixels;
    if (v->one_sample) {
        log_error("%s: the z-test needs a variance of more than one sample per pixel", v->path);
        return false;
    }
    if (!*of_layer && v->rendered) {
        log_error("%s: is a picture without a layer variance (render --variance)", v->path);
        return false;
    }
    if (!*of_layer)
        return true;
    const double samples = v->samples > 0 ? v->samples : request->ref_samples;
    if (!(samples > 0)) {
        log_error("%s: does not say its samples per pixel: its layer variance needs "
                  "--ref-samples N", v->path);
        return false;
    }
    replace(&v->rgb, &v->variance);
    v->variance = (struct image){0};
    const size_t n = 3 * (size_t)v->rgb.width * (size_t)v->rgb.height;
    for (size_t i = 0; i < n; i++)
        v->rgb.pixels[i] *= (float)samples;
    return true;
}

// Those that our variances come from at least, one a sample; 0: they are another renderer's.
static int count_replicates(const struct side *ref, const struct side *test,
                            const struct side *variance) {
    const struct side *sides[] = {ref, test, variance};
    double least = REPLICATES;
    for (int i = 0; i < 3; i++)
        if (sides[i]->rendered && sides[i]->samples > 1)
            least = fmin(least, sides[i]->samples);
    return variance->rendered ? (int)least : 0;
}

static void test_noise(const struct comparison_request *request, const struct side *ref,
                       const struct side *test, const struct side *variance, bool of_layer,
                       struct comparison *result) {
    const double told = request->ref_samples > 0 ? request->ref_samples : ref->samples;
    const struct ztest_input in = {
        .ref = &ref->rgb,
        .test = &test->rgb,
        .variance = &variance->rgb,
        .variance_of_rgb = of_layer,
        .samples = result->samples,
        .ref_samples = told > 0 ? told : MITSUBA_REF_SAMPLES,
        .pixels_of_noisy_ref = told > 0,
        .ref_variance = of_layer && ref->variance.pixels ? &ref->variance : NULL,
        .test_variance = test->variance.pixels ? &test->variance : NULL,
        .replicates = of_layer ? count_replicates(ref, test, variance) : 0,
    };
    result->ref_samples = in.ref_samples;
    ztest_run(&in, &result->ztest);
    result->tested = true;
}

static bool run_ztest(const struct comparison_request *request, const struct side *ref,
                      const struct side *test, struct comparison *result) {
    struct side variance = {0};
    bool of_layer;
    result->samples = request->samples > 0 ? request->samples : test->samples;
    if (!(result->samples > 0)) {
        log_error("%s: does not say its samples per pixel: the z-test needs --samples N",
                  test->path);
        return false;
    }
    bool good = read_single_variance(request, &variance, &of_layer);
    if (good && !same_size(&variance.rgb, &ref->rgb)) {
        log_error("%s: is %d x %d pixels, expected %d x %d as the pictures compared", variance.path,
                  variance.rgb.width, variance.rgb.height, ref->rgb.width, ref->rgb.height);
        good = false;
    }
    if (good)
        test_noise(request, ref, test, &variance, of_layer, result);
    finish_side(&variance);
    return good;
}

static bool write_flip_map(const char *path, struct image *flip) {
    struct image rgb;
    if (!image_init(&rgb, flip->width, flip->height, 3))
        return false;
    const size_t n = (size_t)flip->width * (size_t)flip->height;
    for (size_t p = 0; p < n; p++) {
        flip_magma(flip->pixels[p], rgb.pixels + 3 * p);
        for (int i = 0; i < 3; i++)
            rgb.pixels[3 * p + (size_t)i] = srgb_to_linear(rgb.pixels[3 * p + (size_t)i]);
    }
    const bool good = image_write_png(path, &rgb);
    image_finish(&rgb);
    return good;
}

static bool write_signed_map(const char *path, const struct image *ref, const struct image *test) {
    struct image rgb;
    if (!image_init(&rgb, ref->width, ref->height, 3))
        return false;
    const size_t n = (size_t)ref->width * (size_t)ref->height;
    double sum = 0;
    for (size_t p = 0; p < n; p++)
        sum += isfinite(rgb_luminance(ref->pixels + 3 * p)) ? rgb_luminance(ref->pixels + 3 * p) : 0;
    const float eps = (float)(0.01 * sum / (double)n);
    for (size_t p = 0; p < n; p++) {
        const float b = rgb_luminance(ref->pixels + 3 * p);
        const float e = (rgb_luminance(test->pixels + 3 * p) - b) / (fabsf(b) + eps);
        float *out = rgb.pixels + 3 * p;
        out[0] = e > 0 ? e : fmaxf(-e - 1, 0); // beyond +-1 it goes on to white
        out[2] = e < 0 ? -e : fmaxf(e - 1, 0);
        out[1] = fmaxf(fabsf(e) - 1, 0);
    }
    const bool good = image_write_png(path, &rgb);
    image_finish(&rgb);
    return good;
}

static bool measure(const struct comparison_request *request, const struct side *ref,
                    const struct side *test, struct comparison *result) {
    // The noise of one picture alone, where the other's is there but not known, is too little.
    const bool known = !ref->one_sample && !test->one_sample;
    const struct metrics_input in = {
        .ref = &ref->rgb,
        .test = &test->rgb,
        .ref_variance = known && ref->variance.pixels ? &ref->variance : NULL,
        .test_variance = known && test->variance.pixels ? &test->variance : NULL,
        .eps = request->eps,
        .exposure = request->exposure,
        .threads = request->threads,
    };
    struct image map = {0};
    metrics_measure(&in, &result->metrics);
    const struct perceived values =
        perceived_measure(&in, request->pixels_per_degree, &result->exposures, &map);
    const struct perceived errors =
        perceived_errors(&in, request->pixels_per_degree, &result->exposures);
    result->metrics.ssim = (struct estimate){values.ssim, errors.ssim};
    result->flip_ldr = (struct estimate){values.flip_ldr, errors.flip_ldr};
    result->flip_hdr = (struct estimate){values.flip_hdr, errors.flip_hdr};
    bool good = true;
    if (request->map_path)
        good = request->map == COMPARISON_MAP_FLIP
                   ? write_flip_map(request->map_path, &map)
                   : write_signed_map(request->map_path, &ref->rgb, &test->rgb);
    image_finish(&map);
    return good;
}

bool comparison_run(const struct comparison_request *request, struct comparison *result) {
    struct side ref = {0}, test = {0};
    *result = (struct comparison){0};
    bool good = read_side(request->ref, &ref) && read_side(request->test, &test) &&
                match_sizes(request, &ref, &test);
    if (good) {
        result->width = ref.rgb.width;
        result->height = ref.rgb.height;
        good = (!request->variance || run_ztest(request, &ref, &test, result)) &&
               measure(request, &ref, &test, result);
    }
    if (good && result->metrics.left_out > 0)
        log_warn("%s: %zu values of it or of %s are not finite and were left out", request->test,
                 result->metrics.left_out, request->ref);
    finish_side(&ref);
    finish_side(&test);
    return good;
}
