// SPDX-License-Identifier: Apache-2.0
// Following an environment that turns, by a few wavelets a frame: band by band against differences
// alone and against the largest terms of each frame; on the device and in C; exact after a pause.
#include "curve/largest.h"
#include "driver/precompute_relight.h"
#include "render/picture.h"
#include "replay/follow.h"
#include "replay/relight.h"

enum { WIDTH = 24, HEIGHT = 16, PLANE = WIDTH * HEIGHT, COLUMNS = 32, ROWS = 16 };
enum { CELLS = COLUMNS * ROWS, FRAMES = 12 };

static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='3'/></integrator>"
    "<sensor type='perspective'><float name='fov' value='50'/><transform name='to_world'>"
    "<lookat origin='0,1.5,4' target='0,0.5,0' up='0,1,0'/></transform>"
    "<film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='16'/>"
    "<rfilter type='box'/></film></sensor><emitter type='constant'/>"
    "<shape type='rectangle'><transform name='to_world'><scale value='3'/>"
    "<rotate x='1' angle='-90'/></transform></shape>"
    "<shape type='sphere'><point name='center' y='0.6'/><float name='radius' value='0.6'/>"
    "<bsdf type='roughconductor'><float name='alpha' value='0.2'/></bsdf></shape></scene>";

static char environment[4096], tensor_path[300];
static struct replay *whole;

static struct tensor_file *precompute(void) {
    struct relight_report report;
    scene_write("scene.xml", scene);
    const struct relight_options o = {.job = {.scene = scene_path("scene.xml"), .spp = 64},
                                      .basis = "haar:32x16", .output = tensor_path, .command = "",
                                      .version = ""};
    CHECK(precompute_relight(&o, &report));
    return tensor_open(tensor_path);
}

static float weights_of[FRAMES][3 * CELLS];

static void turn(const struct tensor *t) {
    for (int i = 0; i < FRAMES; i++) {
        const struct relight_lighting l = {.environment = environment, .rotate = 5.0 * i};
        CHECK(relight_weights(t, "t", &l, weights_of[i]));
    }
}

static double relmse(const float *a, const float *b) {
    double sum = 0, mean = 0;
    for (int i = 0; i < 3 * PLANE; i++)
        mean += (double)b[i] / (3 * PLANE);
    for (int i = 0; i < 3 * PLANE; i++)
        sum += pow((double)a[i] - (double)b[i], 2) / (pow((double)b[i], 2) + 1e-3 * mean * mean);
    return sum / (3 * PLANE);
}

// Mean error of the frames, from the fourth on.
static double error_of(const struct tensor *t, uint32_t terms, int way) {
    static float weights[3 * CELLS], frame[3 * PLANE], truth[3 * PLANE];
    const struct follow_options o = {.terms = terms, .rows = ROWS, .columns = COLUMNS,
                                     .one_band = way == 1, .no_device = true};
    struct follow *f = follow_create(t, &o);
    double sum = 0;
    for (int i = 0; i < FRAMES; i++) {
        bool exact;
        memcpy(weights, weights_of[i], sizeof weights);
        CHECK(replay_product(whole, 0, weights) && replay_frame(whole, NULL, truth));
        if (way == 2) {
            keep_largest(weights, CELLS, terms);
            CHECK(replay_product(whole, 0, weights) && replay_frame(whole, NULL, frame));
        } else {
            CHECK(follow_frame(f, weights, frame, &exact));
        }
        sum += i < 3 ? 0 : relmse(frame, truth) / (FRAMES - 3);
    }
    follow_destroy(f);
    return sum;
}

static void bands_follow_best(const struct tensor *t) {
    static const uint32_t counts[] = {32, 64, 128, 192};
    for (int i = 0; i < 4; i++) {
        const double bands = error_of(t, counts[i], 0), one = error_of(t, counts[i], 1);
        const double largest = error_of(t, counts[i], 2);
        printf("%3u of 512 terms a frame: relMSE %.2g band by band, %.2g by differences, %.2g by the "
               "largest terms\n", counts[i], bands, one, largest);
        CHECK(bands < 1.05 * one && bands < largest);
    }
}

// The same bits on the device, and after a pause the picture.
static void comes_to_rest(const struct tensor *t) {
    static float frames[2][3 * PLANE], truth[3 * PLANE];
    struct follow *f[2];
    bool exact = false;
    int pause = 0;
    for (int i = 0; i < 2; i++)
        f[i] = follow_create(t, &(struct follow_options){.terms = 40, .rows = ROWS, .columns = COLUMNS,
                                                         .no_device = i == 0});
    for (int i = 0; i < 40 && !exact; i++) {
        const float *weights = weights_of[i < 6 ? 2 * i : 10];
        pause += i >= 6;
        for (int k = 0; k < 2; k++)
            CHECK(follow_frame(f[k], weights, frames[k], &exact));
        CHECK(memcmp(frames[0], frames[1], sizeof frames[0]) == 0);
    }
    CHECK(replay_product(whole, 0, weights_of[10]) && replay_frame(whole, NULL, truth));
    const double d = relmse(frames[0], truth);
    printf("exact %d frames after the last turn, relMSE %.1e\n", pause, d);
    CHECK(exact && pause <= (CELLS + 39) / 40 && d < 1e-9);
    follow_destroy(f[0]);
    follow_destroy(f[1]);
}

int main(int argc, char **argv) {
    const char *shared = getenv("RELUME_SHARED_DATA");
    if (shared)
        snprintf(environment, sizeof environment, "%s/env/debevec/grace_probe_latlong.hdr", shared);
    else
        snprintf(environment, sizeof environment, "%s", argc > 1 ? argv[1] : "");
    scene_folder_open();
    snprintf(tensor_path, sizeof tensor_path, "%s", scene_path("t.safetensors"));
    struct tensor_file *f = precompute();
    whole = replay_create(tensor_get(f), &(struct replay_options){.no_device = true});
    turn(tensor_get(f));
    bands_follow_best(tensor_get(f));
    comes_to_rest(tensor_get(f));
    replay_destroy(whole);
    tensor_close(f);
    scene_folder_close();
    return check_result();
}
