// SPDX-License-Identifier: Apache-2.0
// One tensor under turned environments against path tracing under the same cells: Grace Cathedral where
// the shared data are, else an interior. Blocks of 8x8 pixels are compared by z-tests.
//
// A block's z has the error of 64 pixels, from two halves and sixteen replicates: nearly normal; above
// 5 in one of 10 000 (Student, 30 degrees of freedom). 180 blocks at most: false alarms 0.004.
#include "driver/precompute_relight.h"
#include "render/picture.h"
#include "replay/relight.h"
#include "replay/replay.h"

enum { WIDTH = 24, HEIGHT = 16, PLANE = WIDTH * HEIGHT, BLOCK = 8 };
enum { COLUMNS = 16, ROWS = 8, CELLS = COLUMNS * ROWS, REPEATED = 64, TURNS = 30 };

static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='5'/></integrator>"
    "<sensor type='perspective'><float name='fov' value='50'/><transform name='to_world'>"
    "<lookat origin='0,1.5,4' target='0,0.5,0' up='0,1,0'/></transform><sampler type='sobol'/>"
    "<film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='16'/>"
    "<rfilter type='box'/></film></sensor>"
    "<emitter type='envmap'><string name='filename' value='%s'/><transform name='to_world'>"
    "<rotate y='1' angle='%g'/></transform></emitter>"
    "<shape type='rectangle'><transform name='to_world'><scale value='3'/>"
    "<rotate x='1' angle='-90'/></transform></shape>"
    "<shape type='sphere'><point name='center' x='-0.7' y='0.6' z='0'/>"
    "<float name='radius' value='0.6'/><bsdf type='roughconductor'><float name='alpha' value='0.2'/>"
    "</bsdf></shape><shape type='sphere'><point name='center' x='0.7' y='0.6' z='0'/>"
    "<float name='radius' value='0.6'/><bsdf type='plastic'/></shape></scene>";

static char environment[4096], tensor_path[300], cells_path[300];

static void trace(const char *sky, double turn, int spp, uint32_t seed, struct image *im) {
    char text[8192];
    struct render_result result;
    snprintf(text, sizeof text, scene, sky, turn);
    render_text(text, &(struct job_options){.spp = spp, .seed = seed, .variance = true}, im, &result);
}

static struct tensor_file *precompute(void) {
    char text[8192];
    struct relight_report report;
    snprintf(text, sizeof text, scene, environment, 0.0);
    scene_write("scene.xml", text);
    const struct relight_options o = {.job = {.scene = scene_path("scene.xml"), .spp = 512, .seed = 7},
                                      .basis = "pixels:16x8", .output = tensor_path, .command = "",
                                      .version = ""};
    CHECK(precompute_relight(&o, &report));
    return tensor_open(tensor_path);
}

// The weights are the cells: large texels, between which interpolation matters little.
static void write_cells(const float *cells) {
    struct image im;
    CHECK(image_init(&im, COLUMNS * REPEATED, ROWS * REPEATED, 3));
    for (int y = 0; y < im.height; y++)
        for (int x = 0; x < im.width; x++)
            memcpy(im.pixels + 3 * (y * im.width + x),
                   cells + 3 * (y / REPEATED * COLUMNS + x / REPEATED), 3 * sizeof *cells);
    CHECK(image_write_exr(cells_path, &im, NULL));
    image_finish(&im);
}

struct sum {
    double difference, variance;
};

static double worst_block(const struct image *im, const float *frame, const float *variance) {
    struct sum blocks[PLANE / (BLOCK * BLOCK)] = {{0, 0}};
    const int first = image_find_channel(im, "variance.R");
    double worst = 0;
    for (int i = 0; i < PLANE; i++) {
        const float *p = im->pixels + (size_t)i * (size_t)im->channels;
        struct sum *s = &blocks[i / WIDTH / BLOCK * (WIDTH / BLOCK) + i % WIDTH / BLOCK];
        s->variance += (double)variance[i];
        for (int k = 0; k < 3; k++) {
            s->difference += ((double)p[k] - (double)frame[k * PLANE + i]) / 3;
            s->variance += (double)p[first + k] / 3;
        }
    }
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        worst = fmax(worst, fabs(blocks[i].difference) / sqrt(blocks[i].variance));
    return worst;
}

// What the cells themselves leave out, without noise: against the environment as it is.
static double error_of_cells(const struct image *cells, double turn) {
    struct image whole;
    double error = 0, noise = 0, mean = 0;
    trace(environment, turn, 1024, 3, &whole);
    const int first = image_find_channel(&whole, "variance.R");
    for (int i = 0; i < PLANE; i++)
        for (int k = 0; k < 3; k++)
            mean += (double)whole.pixels[i * whole.channels + k] / (3 * PLANE);
    for (int i = 0; i < PLANE; i++)
        for (int k = 0; k < 3; k++) {
            const float *a = cells->pixels + i * cells->channels, *b = whole.pixels + i * whole.channels;
            const double size = (double)(b[k] * b[k]) + 1e-3 * mean * mean;
            error += pow((double)(a[k] - b[k]), 2) / size / (3 * PLANE);
            noise += (double)(a[first + k] + b[first + k]) / size / (3 * PLANE);
        }
    image_finish(&whole);
    return error - noise;
}

// Turning a light about +y by an angle turns the picture of `rotate` by the same.
static void turns_are_as_path_traced(int step) {
    struct tensor_file *f = precompute();
    static float frame[3 * PLANE], variance[PLANE], weights[3 * CELLS];
    struct replay *r = replay_create(tensor_get(f), &(struct replay_options){.no_device = true});
    for (int turn = 0; turn < TURNS; turn += step) {
        const struct relight_lighting l = {.environment = environment, .rotate = 12.0 * turn};
        const float *all[] = {weights};
        struct image im;
        CHECK(relight_weights(tensor_get(f), "t", &l, weights));
        CHECK(replay_product(r, 0, weights) && replay_frame(r, NULL, frame));
        replay_variance(r, all, NULL, variance);
        write_cells(weights);
        trace(cells_path, 0, 256, 100 + (uint32_t)turn, &im);
        const double z = worst_block(&im, frame, variance);
        printf("%3d degrees: largest z of a block %.2f", 12 * turn, z);
        if (step == 1 && turn % 10 == 0)
            printf("; relMSE of the cells themselves %.2g", error_of_cells(&im, 12.0 * turn));
        printf("\n");
        CHECK(z < 5);
        image_finish(&im);
    }
    replay_destroy(r);
    tensor_close(f);
}

int main(int argc, char **argv) {
    const char *shared = getenv("RELUME_SHARED_DATA");
    if (shared)
        snprintf(environment, sizeof environment, "%s/env/debevec/grace_probe_latlong.hdr", shared);
    else
        snprintf(environment, sizeof environment, "%s", argc > 1 ? argv[1] : "");
    scene_folder_open();
    snprintf(tensor_path, sizeof tensor_path, "%s", scene_path("t.safetensors"));
    snprintf(cells_path, sizeof cells_path, "%s", scene_path("cells.exr"));
    turns_are_as_path_traced(full_mode() ? 1 : 10);
    scene_folder_close();
    return check_result();
}
