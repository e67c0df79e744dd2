// SPDX-License-Identifier: Apache-2.0
// The scenes with media of lajolla (Tzu-Mao Li): all render, and the stored pictures of them by
// Mitsuba 3 (data/references/lajolla) agree: the means of 8x8 blocks and of the picture within the
// noise of both (image/ztest.h: false alarms 1 % each). The test of single pixels is printed: rare
// bright paths through the smoke are not normal after so few samples.
//
// Some name volumes that their author kept a folder higher: they are read from a folder with links
// to all of them. The other pictures have no reference: where free paths are as short as Mitsuba's ray
// offset it is too dark (test4_2, test5_2, test6: 300 free paths a metre; tests/README.md).
//
// Needs the shared data, and the folder data/references/lajolla as its argument; a name after it
// renders that scene alone.
#include <dirent.h>
#include <limits.h>
#include <unistd.h>

#include "image/ztest.h"
#include "render/picture.h"

enum { SIZE = 24 };

static const struct {
    const char *name;
    bool reference;
    int spp; // four times as many with RELUME_TEST_FULL
} cases[] = {
    {"volpath_test1", true, 64},    {"volpath_test2", true, 256},   {"volpath_test3", true, 256},
    {"volpath_test4", true, 256},   {"volpath_test4_2", false, 16}, {"volpath_test5", true, 256},
    {"volpath_test5_2", false, 16}, {"volpath_test6", false, 16},   {"vol_cbox", true, 256},
    {"vol_cbox_teapot", true, 256}, {"hetvol", true, 64},           {"hetvol_colored", true, 64},
};

static void link_all(const char *folder, const char *extension) {
    DIR *d = opendir(folder);
    if (!d) {
        perror(folder);
        exit(1);
    }
    for (struct dirent *e; (e = readdir(d));) {
        char from[PATH_MAX], name[128];
        const char *dot = strrchr(e->d_name, '.');
        if (!strcmp(e->d_name, "meshes") || (dot && !strcmp(dot, extension))) {
            snprintf(from, sizeof from, "%s/%s", folder, e->d_name);
            snprintf(name, sizeof name, "%.100s", e->d_name);
            CHECK(symlink(from, scene_path(name)) == 0);
        }
    }
    closedir(d);
}

// The scene with a box filter, in which pixels are independent of one another.
static void write_with_box(const char *path) {
    const char gaussian[] = "<rfilter type=\"gaussian\"";
    size_t size;
    char *text = file_read(path, 0, &size);
    char *at = text ? strstr(text, gaussian) : NULL;
    if (!at) {
        printf("%s: no gaussian filter\n", path);
        exit(1);
    }
    char *changed = mem_array(size + 1, 1);
    snprintf(changed, size + 1, "%.*s<rfilter type=\"box\"%s", (int)(at - text), text,
             at + sizeof gaussian - 1);
    scene_write("scene.xml", changed);
    mem_free(changed);
    mem_free(text);
}

static void layer_of(const struct image *im, const char *layer, struct image *rgb) {
    if (!image_layer_to_rgb(im, layer, "the picture", rgb))
        exit(1);
}

static void compare(const char *path, const struct image *im, int spp) {
    struct image picture, ref, variance, test, error;
    struct ztest_result r;
    if (!image_read(path, &picture))
        exit(1);
    const struct image_attribute *samples = image_find_attribute(&picture, "samples");
    const double n = samples ? samples->number : 0;
    CHECK(n > 0);
    layer_of(&picture, "", &ref);
    layer_of(&picture, "variance", &variance);
    layer_of(im, "", &test);
    layer_of(im, "variance", &error);
    for (int i = 0; i < 3 * SIZE * SIZE; i++) // of a single sample
        variance.pixels[i] *= (float)n;
    ztest_run(&(struct ztest_input){.ref = &ref, .test = &test, .variance = &variance,
                                    .variance_of_rgb = true, .samples = spp, .ref_samples = n, .test_variance = &error}, &r);
    printf("  mean differs by %.3f %% +- %.3f %%, largest z of blocks %.2f, of pixels %.2f\n",
           100 * r.relative_difference, 100 * r.relative_error, r.blocks.largest_z,
           r.pixels.largest_z);
    CHECK(r.blocks.pass);
    CHECK(r.mean.pass);
    image_finish(&picture);
    image_finish(&ref);
    image_finish(&variance);
    image_finish(&test);
    image_finish(&error);
}

static void check_values(const struct image *im) {
    const size_t n = (size_t)im->width * (size_t)im->height * (size_t)im->channels;
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        CHECK(isfinite(im->pixels[i]) && im->pixels[i] >= 0);
        sum += (double)im->pixels[i];
    }
    CHECK(sum > 0);
}

static void test_scene(const char *folder, const char *references, size_t i) {
    char path[PATH_MAX];
    struct render_result result;
    struct image im;
    const struct job_options o = {
        .spp = full_mode() ? 4 * cases[i].spp : cases[i].spp, .variance = true,
        .reading = {.sampler = "independent", .width = SIZE, .height = SIZE}};
    snprintf(path, sizeof path, "%s/%s.xml", folder, cases[i].name);
    write_with_box(path);
    render_file(scene_path("scene.xml"), &o, &im, &result);
    printf("%s, %d samples\n", cases[i].name, o.spp);
    check_values(&im);
    snprintf(path, sizeof path, "%s/%s.exr", references, cases[i].name);
    if (cases[i].reference)
        compare(path, &im, o.spp);
    image_finish(&im);
    fflush(stdout);
}

int main(int argc, char **argv) {
    const char *data = getenv("RELUME_SHARED_DATA");
    char grids[PATH_MAX / 2], folder[PATH_MAX - 64];
    if (!data || argc < 2) {
        printf("RELUME_SHARED_DATA is not set, or no folder of references is given\n");
        return 77;
    }
    snprintf(grids, sizeof grids, "%s/volumes", data);
    snprintf(folder, sizeof folder, "%s/lajolla-volpath-scenes", grids);
    scene_folder_open();
    link_all(grids, ".vol");
    link_all(folder, ".obj");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        if (argc < 3 || strcmp(argv[2], cases[i].name) == 0)
            test_scene(folder, argv[1], i);
    scene_folder_close();
    return check_result();
}
