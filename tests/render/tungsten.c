// SPDX-License-Identifier: Apache-2.0
// Two scenes by B. Bitterli against the converged pictures that another renderer, Tungsten, made of
// them: the means agree, and the error falls with our noise until the reference's own is left.
//
// Rendered with the reference's filter at its size, then both are averaged over boxes. The scenes
// are those in data/scenes, whose walls are lit on both sides as Tungsten has it; the reference of
// veach-mis was made with one bounce (its mean lies 1.4 % below that of two).
//
// Needs the shared data, and the folder data/scenes as its argument.
#include <limits.h>

#include "image/metrics.h"
#include "render/picture.h"

struct scene_case {
    const char *name;
    int max_depth, factor;
    double most_relmse; // of the reference: its noise, and materials that are not quite the same
};

static const struct scene_case cases[] = {
    {"cornell-box", 65, 2, 2e-4},
    {"veach-mis", 2, 4, 2e-3},
};

static const double MOST_MEAN_DIFFERENCE = 0.005;

// The scene file, with the reference's filter.
static void write_with_tent(const char *path) {
    const char box[] = "<rfilter type=\"box\"", tent[] = "<rfilter type=\"tent\"";
    size_t size;
    char *text = file_read(path, 0, &size);
    char *at = text ? strstr(text, box) : NULL;
    if (!at) {
        printf("%s: no box filter\n", path);
        exit(1);
    }
    char *changed = mem_array(size + sizeof tent, 1);
    snprintf(changed, size + sizeof tent, "%.*s%s%s", (int)(at - text), text, tent,
             at + sizeof box - 1);
    scene_write("scene.xml", changed);
    mem_free(changed);
    mem_free(text);
}

static void downsample_layer(const struct image *im, const char *layer, int factor,
                             struct image *out) {
    struct image rgb;
    if (!image_layer_to_rgb(im, layer, layer, &rgb) || !image_downsample(&rgb, factor, out))
        exit(1);
    image_finish(&rgb);
}

struct errors {
    double mean_ratio, mean_error, relmse, noise;
};

static struct errors measure_errors(const struct scene_case *c, int spp, const struct image *ref) {
    const struct job_options o = {.spp = spp, .variance = true, .max_depth = c->max_depth,
                                  .reading = {.sampler = "independent", .width = ref->width * c->factor,
                                              .height = ref->height * c->factor}};
    struct render_result result;
    struct image im, test, variance;
    struct metrics m;
    render_file(scene_path("scene.xml"), &o, &im, &result);
    downsample_layer(&im, "", c->factor, &test);
    downsample_layer(&im, "variance", c->factor, &variance);
    const int values = variance.width * variance.height * 3;
    for (int i = 0; i < values; i++) // of a mean of independent values
        variance.pixels[i] /= (float)(c->factor * c->factor);
    const struct metrics_input in = {.ref = ref, .test = &test, .test_variance = &variance,
                                     .eps = -1};
    metrics_measure(&in, &m);
    image_finish(&im);
    image_finish(&test);
    image_finish(&variance);
    return (struct errors){m.mean_ratio.value, m.mean_ratio.error, m.relmse.value, m.relmse_noise};
}

static void test_scene(const struct scene_case *c, const char *scenes, const char *data) {
    const int most = full_mode() ? 64 : 16;
    char path[PATH_MAX];
    struct image picture, ref;
    double left_over = INFINITY, first_noise = 0;
    snprintf(path, sizeof path, "%s/%s/scene.xml", scenes, c->name);
    write_with_tent(path);
    snprintf(path, sizeof path, "%s/scenes/bitterli/%s/TungstenRender.exr", data, c->name);
    if (!image_read(path, &picture))
        exit(1);
    downsample_layer(&picture, "", c->factor, &ref);
    image_finish(&picture);
    printf("%s, boxes of %dx%d:\n%4s %22s %12s %12s %12s\n", c->name, c->factor, c->factor, "spp",
           "mean ratio", "relMSE", "our noise", "left over");
    for (int spp = 4; spp <= most; spp *= 4) {
        const struct errors e = measure_errors(c, spp, &ref);
        left_over = e.relmse - e.noise;
        printf("%4d  %9.5f +- %8.5f %12.3e %12.3e %12.3e\n", spp, e.mean_ratio, e.mean_error,
               e.relmse, e.noise, left_over);
        CHECK_NEAR(e.mean_ratio, 1, MOST_MEAN_DIFFERENCE);
        CHECK(fabs(left_over) <= c->most_relmse + 0.05 * e.noise);
        if (spp == 4)
            first_noise = e.noise;
        CHECK_NEAR(e.noise * spp / (4 * first_noise), 1, 0.15); // as 1 / N
    }
    CHECK(left_over < c->most_relmse);
    image_finish(&ref);
}

int main(int argc, char **argv) {
    const char *data = getenv("RELUME_SHARED_DATA");
    if (!data || argc != 2) {
        printf("RELUME_SHARED_DATA is not set, or no folder of scenes is given\n");
        return 77;
    }
    scene_folder_open();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        test_scene(&cases[i], argv[1], data);
    scene_folder_close();
    return check_result();
}
