// SPDX-License-Identifier: Apache-2.0
// Scenes of Mitsuba 3's own render tests against its stored pictures (32 000 samples a pixel, with
// the variance of one sample): the per-pixel test of Mitsuba at 2e6 samples a picture by independent
// numbers, which finds wrong spots; and with --full, at 32 000 samples a pixel, the means of 8x8
// blocks and of the picture, noise of both sides included, which find a small uniform bias.
//
// Mitsuba summed those samples in single precision, in CIE XYZ. Where a pixel's samples take only a
// few values (a sky, facets under the sun), the roundings of 32 000 additions go the same way, by up
// to 0.1 %: Mitsuba with short sums differs from its own reference of mesh_attributes by 0.034 %,
// five standard errors. So the test at 32 000 samples sums as Mitsuba did; with fewer, the mean may
// differ by what the roundings can make.
//
// Needs the shared data. Left out: scenes with participating media or the principled material.
#include <limits.h>

#include "image/ztest.h"
#include "render/picture.h"

static const double PICTURE_SAMPLES = 2e6, REF_SAMPLES = 32000;

// left_out: pixels x0, y0, x1, y1 that the means do without. Two leaves with partly transparent edges
// stand there; the Mitsuba of these references (3.2.1 still does it, 3.9.1 does not) sampled a mask
// with a density that lacked the opacity, so that the weights of light and material sampling had a
// sum above 1: their edges are too bright, by 0.1 % of the block.
static const struct {
    const char *folder, *name, *integrator;
    int left_out[4];
} cases[] = {
    {"bsdf_spheres", "test_arealight", "path"},
    {"bsdf_spheres", "test_constant", "path", {24, 32, 48, 40}},
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

// ---- pictures -------------------------------------------------------------------------------

static struct job_options options_of(const char *scene, const struct scene_define *integrator) {
    return (struct job_options){.scene = scene, .variance = true,
                                .reading = {.sampler = "independent", .defines = integrator,
                                            .define_count = 1}};
}

static void render_at_once(const struct job_options *options, int spp, struct image *test,
                           struct image *error) {
    struct job_options o = *options;
    struct render_result result;
    struct image im;
    o.spp = spp;
    render_file(o.scene, &o, &im, &result);
    if (!image_to_rgb(&im, test) || !image_layer_to_rgb(&im, "variance", o.scene, error))
        exit(1);
    image_finish(&im);
}

static const float to_xyz[3][3] = {{0.412453f, 0.357580f, 0.180423f},
                                   {0.212671f, 0.715160f, 0.072169f},
                                   {0.019334f, 0.119193f, 0.950227f}};
static const double to_rgb[3][3] = {{3.240479, -1.537150, -0.498535},
                                    {-0.969256, 1.875991, 0.041556},
                                    {0.055648, -0.204043, 1.057311}};

struct sums {
    float *xyz;            // as Mitsuba's film has it
    double *rgb, *squares; // for the standard error
};

static void add_sample(const struct image *im, struct sums *s) {
    for (int i = 0; i < im->width * im->height; i++) {
        const float *p = im->pixels + (size_t)i * (size_t)im->channels;
        for (int c = 0; c < 3; c++) {
            const float *m = to_xyz[c];
            s->xyz[3 * i + c] += m[0] * p[0] + m[1] * p[1] + m[2] * p[2];
            s->rgb[3 * i + c] += (double)p[c];
            s->squares[3 * i + c] += (double)p[c] * (double)p[c];
        }
    }
}

static void finish_sums(const struct sums *s, int n, struct image *test, struct image *error) {
    for (int i = 0; i < 3 * test->width * test->height; i++) {
        const float *xyz = s->xyz + i / 3 * 3;
        const double *m = to_rgb[i % 3], mean = s->rgb[i] / n;
        test->pixels[i] = (float)((m[0] * (double)xyz[0] + m[1] * (double)xyz[1] +
                                   m[2] * (double)xyz[2]) / n);
        error->pixels[i] = (float)(fmax(s->squares[i] / n - mean * mean, 0) / n);
    }
}

// One picture a sample, with a seed of its own.
static void render_one_by_one(const struct job_options *options, int spp, struct image *test,
                              struct image *error) {
    struct job_options o = *options;
    struct job job;
    o.spp = 1;
    o.variance = false;
    if (!job_open(&job, &o))
        exit(1);
    const struct film_settings *film = &job.scene->film;
    const size_t values = 3 * (size_t)film->width * (size_t)film->height;
    struct sums s = {mem_array(values, sizeof(float)), mem_array(values, sizeof(double)),
                     mem_array(values, sizeof(double))};
    if (!image_init(test, film->width, film->height, 3) ||
        !image_init(error, film->width, film->height, 3))
        exit(1);
    for (int i = 0; i < spp; i++) {
        struct render_result result;
        struct image im;
        job.render.seed = (uint32_t)i + 1;
        struct film *f = job_render(&job, &result);
        if (!job_image(&job, f, &result, &im))
            exit(1);
        add_sample(&im, &s);
        image_finish(&im);
        film_destroy(f);
    }
    finish_sums(&s, spp, test, error);
    mem_free(s.xyz);
    mem_free(s.rgb);
    mem_free(s.squares);
    job_close(&job);
}

// What the reference gives as the variance of a constant pixel is rounding, negative or positive.
static void clear_constant(const struct image *error, struct image *variance) {
    for (int i = 0; i < error->width * error->height; i++) {
        const float *e = error->pixels + 3 * i;
        if (e[0] + e[1] + e[2] < 1e-12f)
            memset(variance->pixels + 3 * i, 0, 3 * sizeof(float));
    }
}

static void leave_out(const int box[4], const struct image *test, struct image *ref,
                      struct image *variance) {
    for (int y = box[1]; y < box[3]; y++)
        for (int x = box[0]; x < box[2]; x++) {
            memcpy(pixel_at(ref, x, y), pixel_at(test, x, y), 3 * sizeof(float));
            memset(pixel_at(variance, x, y), 0, 3 * sizeof(float));
        }
}

// ---- tests ----------------------------------------------------------------------------------

static void print_level(const char *name, const struct ztest_level *l) {
    printf("  %-7s %7.3f %% of %4zu agree, largest z %.2f\n", name, 100 * l->share, l->values,
           l->largest_z);
}

static struct ztest_result compare(const char *folder, size_t i, bool many) {
    char path[PATH_MAX];
    struct image ref, variance, test, error;
    struct ztest_result r;
    snprintf(path, sizeof path, "%s/refs/%s_ref_rgb.exr", folder, cases[i].name);
    read_rgb(path, &ref);
    snprintf(path, sizeof path, "%s/refs/%s_ref_rgb_var.exr", folder, cases[i].name);
    read_rgb(path, &variance);
    snprintf(path, sizeof path, "%s/%s_%s.xml", folder, cases[i].name, cases[i].integrator);
    const struct scene_define integrator = {"integrator", cases[i].integrator};
    const struct job_options o = options_of(path, &integrator);
    const int spp = (int)(many ? REF_SAMPLES : PICTURE_SAMPLES / (ref.width * ref.height));
    if (many) {
        render_one_by_one(&o, spp, &test, &error);
        clear_constant(&error, &variance);
        leave_out(cases[i].left_out, &test, &ref, &variance);
    } else {
        render_at_once(&o, spp, &test, &error);
    }
    const struct ztest_input in = {.ref = &ref, .test = &test, .variance = &variance,
                                   .samples = spp, .ref_samples = REF_SAMPLES,
                                   .test_variance = &error};
    ztest_run(&in, &r);
    printf("%s, %s, %d samples: mean differs by %.4f %% +- %.4f %%\n", cases[i].name,
           cases[i].integrator, spp, 100 * r.relative_difference, 100 * r.relative_error);
    image_finish(&ref);
    image_finish(&variance);
    image_finish(&test);
    image_finish(&error);
    return r;
}

static void test_scene(const char *data, size_t i) {
    char folder[PATH_MAX / 2];
    snprintf(folder, sizeof folder, "%s/scenes/mitsuba-tests/%s", data, cases[i].folder);
    struct ztest_result r = compare(folder, i, false);
    print_level("pixels", &r.pixels);
    CHECK(r.pixels.pass);
    CHECK_NEAR(r.relative_difference, 0, REF_SAMPLES * 0x1p-25 + 4 * r.relative_error);
    if (full_mode()) {
        r = compare(folder, i, true);
        print_level("blocks", &r.blocks);
        print_level("mean", &r.mean);
        CHECK(r.blocks.pass);
        CHECK(r.mean.pass);
    }
    fflush(stdout);
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
