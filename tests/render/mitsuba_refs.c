// SPDX-License-Identifier: Apache-2.0
// Scenes of Mitsuba 3's own render tests against its stored pictures (32 000 samples a pixel, with
// the variance of one sample): the per-pixel test of Mitsuba at 2e6 samples a picture by independent
// numbers, which finds wrong spots; and with --full, at 32 000 samples a pixel, the means of 8x8
// blocks and of the picture, noise of both sides included, which find a small uniform bias.
//
// Needs the shared data. Left out: scenes with participating media or the principled material.
#include <limits.h>

#include "image/ztest.h"
#include "render/picture.h"

static const double PICTURE_SAMPLES = 2e6, REF_SAMPLES = 32000;

static const struct {
    const char *folder, *name, *integrator;
} cases[] = {
    {"bsdf_spheres", "test_arealight", "path"},
    {"bsdf_spheres", "test_constant", "path"},
    {"bsdf_spheres", "test_envmap", "path"},
    {"bsdf_spheres", "test_roughdielectric", "path"},
    {"bsdf_spheres", "test_roughplastic_linear", "path"},
    {"bsdf_spheres", "test_textured_diffuse", "path"},
    {"floating_sphere", "test_directional", "direct"},
    {"instancing", "test_instancing", "path"},
    {"mesh_attributes", "test_mesh_attributes_1_face", "direct"},
    {"spot_light", "test_spot", "direct"},
};

static void read_rgb(const char *path, struct image *rgb) {
    struct image im;
    if (!image_read(path, &im) || !image_to_rgb(&im, rgb))
        exit(1);
    image_finish(&im);
}

// Mitsuba summed the references in single precision, in CIE XYZ. Where all samples are equal (the
// sky of test_constant), the roundings of 32 000 additions all go the same way, up to 0.1 %. So that
// very sum is repeated, and its error taken out of the reference.
static void repeat_sum(float value, double *error, double *variance) {
    float sum = 0, squares = 0;
    for (int i = 0; i < (int)REF_SAMPLES; i++) {
        sum += value;
        squares += value * value;
    }
    const float mean = sum / (float)REF_SAMPLES;
    *error = (double)mean - (double)value;
    *variance = (double)squares / REF_SAMPLES - (double)mean * (double)mean;
}

static const double to_xyz[3][3] = {{0.412453, 0.357580, 0.180423},
                                    {0.212671, 0.715160, 0.072169},
                                    {0.019334, 0.119193, 0.950227}};
static const double to_rgb[3][3] = {{3.240479, -1.537150, -0.498535},
                                    {-0.969256, 1.875991, 0.041556},
                                    {0.055648, -0.204043, 1.057311}};

static void multiply(const double m[3][3], const double in[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = m[i][0] * in[0] + m[i][1] * in[1] + m[i][2] * in[2];
}

// What the reference's rounding added to its value and variance of a pixel of that constant colour.
static void rounding_of(const float *rgb, double error[3], double variance[3]) {
    const double in[3] = {(double)rgb[0], (double)rgb[1], (double)rgb[2]};
    double xyz[3], e[3], v[3];
    multiply(to_xyz, in, xyz);
    for (int c = 0; c < 3; c++)
        repeat_sum((float)xyz[c], &e[c], &v[c]);
    multiply(to_rgb, e, error);
    multiply(to_rgb, v, variance);
}

// Of the pixels that are constant in both pictures, and lit; returns how many.
static int remove_rounding(const struct image *test, const struct image *own, struct image *ref,
                           struct image *variance) {
    int corrected = 0;
    double error[3] = {0}, spread[3] = {0};
    const float *last = NULL;
    for (int i = 0; i < test->width * test->height; i++) {
        const float *t = test->pixels + 3 * i, *o = own->pixels + 3 * i;
        float *r = ref->pixels + 3 * i, *v = variance->pixels + 3 * i;
        if (o[0] > 0 || o[1] > 0 || o[2] > 0 || !(t[0] + t[1] + t[2] > 0))
            continue;
        if (!last || memcmp(last, t, 3 * sizeof *t) != 0)
            rounding_of(t, error, spread);
        last = t;
        bool constant = true;
        for (int c = 0; c < 3; c++)
            constant &= fabs((double)v[c] - spread[c]) < 1e-5 * (double)(t[c] * t[c]);
        for (int c = 0; c < 3 && constant; c++) {
            r[c] -= (float)error[c];
            v[c] = 0;
        }
        corrected += constant;
    }
    return corrected;
}

// One picture: the z-test's verdict over all of its levels.
static struct ztest_result compare(const char *scene, const char *integrator, int spp,
                                   struct image *ref, struct image *variance) {
    const struct scene_define define = {"integrator", integrator};
    const struct job_options o = {.spp = spp, .variance = true,
                                  .reading = {.sampler = "independent", .defines = &define,
                                              .define_count = 1}};
    struct render_result rendered;
    struct image im, test, own;
    struct ztest_result result;
    render_file(scene, &o, &im, &rendered);
    if (!image_to_rgb(&im, &test) || !image_layer_to_rgb(&im, "variance", scene, &own))
        exit(1);
    const int constant = remove_rounding(&test, &own, ref, variance);
    if (constant)
        printf("%d constant pixels of the reference are freed of its rounding\n", constant);
    const struct ztest_input in = {.ref = ref, .test = &test, .variance = variance,
                                   .samples = spp, .ref_samples = REF_SAMPLES,
                                   .test_variance = &own};
    ztest_run(&in, &result);
    image_finish(&im);
    image_finish(&test);
    image_finish(&own);
    return result;
}

static void print_level(const char *name, const struct ztest_level *l) {
    printf("  %-7s %7.3f %% of %4zu agree, largest z %.2f\n", name, 100 * l->share, l->values,
           l->largest_z);
}

static void test_scene(const char *data, size_t i) {
    char folder[PATH_MAX / 2], scene[PATH_MAX], ref_path[PATH_MAX], variance_path[PATH_MAX];
    struct image ref, variance;
    snprintf(folder, sizeof folder, "%s/scenes/mitsuba-tests/%s", data, cases[i].folder);
    snprintf(scene, sizeof scene, "%s/%s_%s.xml", folder, cases[i].name, cases[i].integrator);
    snprintf(ref_path, sizeof ref_path, "%s/refs/%s_ref_rgb.exr", folder, cases[i].name);
    snprintf(variance_path, sizeof variance_path, "%s/refs/%s_ref_rgb_var.exr", folder,
             cases[i].name);
    read_rgb(ref_path, &ref);
    read_rgb(variance_path, &variance);
    const int spp = (int)(PICTURE_SAMPLES / (ref.width * ref.height));
    struct ztest_result r = compare(scene, cases[i].integrator, spp, &ref, &variance);
    printf("%s, %s: mean differs by %.3f %% +- %.3f %%\n", cases[i].name, cases[i].integrator,
           100 * r.relative_difference, 100 * r.relative_error);
    print_level("pixels", &r.pixels);
    CHECK(r.pixels.pass);
    if (full_mode()) {
        r = compare(scene, cases[i].integrator, (int)REF_SAMPLES, &ref, &variance);
        printf("  at %g samples: mean differs by %.4f %% +- %.4f %%\n", REF_SAMPLES,
               100 * r.relative_difference, 100 * r.relative_error);
    }
    print_level("blocks", &r.blocks);
    print_level("mean", &r.mean);
    CHECK(r.blocks.pass);
    CHECK(r.mean.pass);
    fflush(stdout);
    image_finish(&ref);
    image_finish(&variance);
}

int main(void) {
    const char *data = getenv("RELUME_SHARED_DATA");
    if (!data) {
        printf("RELUME_SHARED_DATA is not set\n");
        return 77;
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        test_scene(data, i);
    return check_result();
}
