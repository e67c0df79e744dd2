// SPDX-License-Identifier: Apache-2.0
// Ranges of lights: four quarters of the sky's triangles merge to the whole, with the lights that are
// sampled and with what is not editable. Work that is stopped is gone on with to the same bytes; with all
// bounces, what is whole by then is written.
#include <sys/stat.h>

#include "driver/precompute_polynomial.h"
#include "edit_picture.h"
#include "scene_text.h"
#include "transport/tensor_remake.h"

static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'/>"
    "<sensor type='perspective'><float name='fov' value='35'/>"
    "<transform name='to_world'><lookat origin='0,3,6' target='0,0.6,0' up='0,1,0'/></transform>"
    "<film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='20'/>"
    "</film></sensor><emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>"
    "<emitter type='point'><point name='position' x='1' y='3' z='2'/></emitter>"
    "<bsdf type='editable' id='m'><float name='exponent' value='300'/><integer name='bins' value='64'/>"
    "<boolean name='fixed_fresnel' value='true'/><rgb name='diffuse_reflectance' value='0.3'/></bsdf>"
    "<shape type='sphere'><transform name='to_world'><translate y='1'/></transform>"
    "<ref id='m'/></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='4'/>"
    "<rotate x='1' angle='-90'/></transform></shape></scene>";

static char paths[6][300];

enum { SKY_WIDE = 32, SKY_HIGH = 16 };

static double waves(int x, int y, int channel, const void *ctx) {
    (void)channel;
    (void)ctx;
    return (double)(x == 9 && y == 5 ? 300.0f : 0.5f + 0.4f * sinf((float)(y * SKY_WIDE + x)));
}

static struct edit_options options_of(uint32_t first, uint32_t end, const char *output) {
    return (struct edit_options){.job = {.scene = scene_path("scene.xml"), .spp = 4, .threads = 2},
                                 .lights = end, .first = first, .light_samples = 2,
                                 .packets = "pixels", .output = output, .command = "test",
                                 .version = "test"};
}

static void make(uint32_t first, uint32_t end, const char *output) {
    struct edit_report r;
    const struct edit_options o = options_of(first, end, output);
    CHECK(precompute_edit(&o, &r));
}

static double difference(const char *a, const char *b) {
    struct edit_picture x, y;
    CHECK(edit_picture_replay(a, true, &x) && edit_picture_replay(b, true, &y));
    const double d = edit_picture_largest(&x, &y);
    edit_picture_free(&x);
    edit_picture_free(&y);
    return d;
}

// Sums of floats in another order, rounded to float in each part.
static void quarters_are_the_whole(void) {
    const char *parts[4] = {paths[2], paths[0], paths[3], paths[1]}; // in any order
    struct tensor_remade r;
    for (uint32_t i = 0; i < 4; i++)
        make(500 * i, 500 * (i + 1), paths[i]);
    make(0, 2000, paths[4]);
    const struct tensor_remake merge = {.paths = parts, .count = 4, .command = "test"};
    CHECK(tensor_remake(&merge, paths[5], &r) && r.samples == 4);
    const double d = difference(paths[5], paths[4]), refined = difference(paths[0], paths[4]);
    printf("four quarters differ from the whole by %.1e of the brightest, the first by %.1e\n", d,
           refined);
    CHECK(d < 1e-6 && refined > 1e-3);
    struct tensor_file *f = tensor_open(paths[5]), *whole = tensor_open(paths[4]);
    CHECK(tensor_get(f)->blocks[0].halves &&
          memcmp(tensor_get(f)->blocks[0].halves, tensor_get(whole)->blocks[0].halves,
                 tensor_bytes(&tensor_get(f)->blocks[0])) == 0);
    tensor_close(f);
    tensor_close(whole);
}

static void ranges_with_gaps_are_refused(void) {
    const char *parts[2] = {paths[0], paths[2]}, *twice[3] = {paths[0], paths[1], paths[1]};
    struct tensor_remade r;
    capture_begin();
    const struct tensor_remake gap = {.paths = parts, .count = 2, .command = "test"};
    const struct tensor_remake same = {.paths = twice, .count = 3, .command = "test"};
    const bool merged = tensor_remake(&gap, paths[5], &r) || tensor_remake(&same, paths[5], &r);
    capture_end();
    CHECK(!merged && captured_has("lights from 500 on"));
}

static volatile sig_atomic_t stop;

static void stop_midway(void *user, double done) {
    (void)user;
    stop = done > 0.3;
}

static bool same_bytes(const char *a, const char *b) {
    size_t n, m;
    char *x = file_read(a, 1 << 28, &n), *y = file_read(b, 1 << 28, &m);
    const bool same = x && y && n == m && memcmp(x, y, n) == 0;
    mem_free(x);
    mem_free(y);
    return same;
}

static void work_goes_on(void) {
    struct edit_report r;
    struct stat st;
    char part[320];
    struct edit_options o = options_of(0, 2000, paths[0]);
    snprintf(part, sizeof part, "%s.part", paths[0]);
    unlink(paths[0]);
    o.resume = true;
    o.job.stop = &stop;
    o.job.threads = 1; // progress is told by one of them, and the others may be done by then
    o.progress = stop_midway;
    capture_begin();
    const bool whole = precompute_edit(&o, &r);
    capture_end();
    CHECK(!whole && r.stopped && captured_has("goes on"));
    CHECK(stat(part, &st) == 0 && stat(paths[0], &st) != 0);
    const uint64_t rays = r.rays;
    stop = 0;
    o.job.threads = 0;
    o.progress = NULL;
    CHECK(precompute_edit(&o, &r));
    CHECK(r.rays > 0 && stat(part, &st) != 0 && same_bytes(paths[0], paths[4]));
    printf("stopped after %llu rays, %llu more were left\n", (unsigned long long)rays,
           (unsigned long long)r.rays);
    o.job.seed = 1; // another tensor: begun anew
    CHECK(precompute_edit(&o, &r) && !same_bytes(paths[0], paths[4]));
}

static void stop_at_the_end(void *user, double done) {
    (void)user;
    stop = done >= 1;
}

// A stop that comes when the last strip is traced, before it is said that the pass is done.
static void whole_passes_are_written(void) {
    struct polynomial_report r;
    struct stat st;
    const struct polynomial_options o = {
        .job = {.scene = scene_path("scene.xml"), .spp = 64, .threads = 1, .stop = &stop}, .bounces = 1,
        .series = {16}, .output = paths[0], .command = "test", .version = "test",
        .progress = stop_at_the_end};
    unlink(paths[0]);
    capture_begin();
    const bool whole = precompute_polynomial(&o, &r);
    capture_end();
    CHECK(stop && whole && !r.stopped && r.samples == 64 && stat(paths[0], &st) == 0);
    stop = 0;
}

int main(void) {
    scene_folder_open();
    scene_write("scene.xml", scene);
    edit_picture_write_sky(scene_path("sky.exr"), SKY_WIDE, SKY_HIGH, waves, NULL);
    for (int i = 0; i < 6; i++) {
        char name[32];
        snprintf(name, sizeof name, "%d.safetensors", i);
        snprintf(paths[i], sizeof paths[i], "%s", scene_path(name));
    }
    quarters_are_the_whole();
    ranges_with_gaps_are_refused();
    work_goes_on();
    whole_passes_are_written();
    scene_folder_close();
    return check_result();
}
