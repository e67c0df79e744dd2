// SPDX-License-Identifier: Apache-2.0
// Relighting tensors: the same random numbers through the film and through tensor and product give
// the same picture; another lighting gives the picture that path tracing gives under it; the error
// that the half-sums tell of is the error.
#include "driver/precompute_relight.h"
#include "render/picture.h"
#include "replay/relight.h"
#include "replay/replay.h"

enum { WIDTH = 40, HEIGHT = 28, SPP = 64, PLANE = WIDTH * HEIGHT };

static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='5'/></integrator>"
    "<sensor type='perspective'><float name='fov' value='50'/><transform name='to_world'>"
    "<lookat origin='0,1.5,4' target='0,0.5,0' up='0,1,0'/></transform><sampler type='sobol'/>"
    "<film type='hdrfilm'><integer name='width' value='40'/><integer name='height' value='28'/>"
    "<rfilter type='mitchell'/></film></sensor>"
    "%s"
    "<emitter type='point' id='lamp'><point name='position' x='-2' y='3' z='2'/>"
    "<rgb name='intensity' value='9,7,5'/></emitter>"
    "<shape type='rectangle'><transform name='to_world'><scale value='3'/>"
    "<rotate x='1' angle='-90'/></transform></shape>"
    "<shape type='rectangle' id='panel'><transform name='to_world'><scale value='0.4'/>"
    "<rotate x='1' angle='90'/><translate y='2.5'/></transform><emitter type='area'/></shape>"
    "<shape type='sphere'><point name='center' x='-0.7' y='0.6' z='0'/>"
    "<float name='radius' value='0.6'/><bsdf type='roughconductor'><float name='alpha' value='0.2'/>"
    "</bsdf></shape><shape type='sphere'><point name='center' x='0.7' y='0.6' z='0'/>"
    "<float name='radius' value='0.6'/><bsdf type='plastic'/></shape></scene>";

static const char grey_sky[] =
    "<emitter type='constant' id='sky'><rgb name='radiance' value='1'/></emitter>";

static char tensor_path[300], cells_path[300];

// A tensor of the scene, read back.
static struct tensor_file *precompute(const char *sky, const char *basis, int spp, uint32_t seed) {
    char text[8192];
    struct relight_report report;
    snprintf(text, sizeof text, scene, sky);
    scene_write("scene.xml", text);
    const struct relight_options o = {
        .job = {.scene = scene_path("scene.xml"), .spp = spp, .seed = seed}, .basis = basis,
        .output = tensor_path, .command = "", .version = ""};
    if (!precompute_relight(&o, &report))
        exit(1);
    struct tensor_file *f = tensor_open(tensor_path);
    CHECK(f && tensor_check_values(f));
    return f;
}

static void replayed(const struct tensor_file *f, const float *weights, float *frame,
                     float *variance) {
    const struct tensor *t = tensor_get(f);
    struct replay *r = replay_create(t, &(struct replay_options){.no_device = true});
    CHECK(replay_product(r, 0, weights) && replay_frame(r, NULL, frame));
    if (variance)
        replay_variance(r, &weights, NULL, variance);
    replay_destroy(r);
}

// The film's picture from the random numbers that a tensor is made with.
static void traced(const char *sky, int spp, uint32_t seed, struct image *im) {
    char text[8192];
    struct job job;
    struct render_result result;
    snprintf(text, sizeof text, scene, sky);
    scene_write("scene.xml", text);
    if (!job_open(&job, &(struct job_options){.scene = scene_path("scene.xml"), .spp = spp,
                                              .seed = seed, .light_groups = true}))
        exit(1);
    job.render.tracer.replicates = 2;
    struct film *film = job_render(&job, &result);
    CHECK(job_image(&job, film, &result, im));
    film_destroy(film);
    job_close(&job);
}

static double layer_difference(const struct image *im, const char *layer, const float *frame) {
    double worst = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        char name[64];
        snprintf(name, sizeof name, "%s%s%c", layer, *layer ? "." : "", "RGB"[k]);
        const int channel = image_find_channel(im, name);
        for (int i = 0; i < PLANE; i++) {
            const double a = (double)im->pixels[i * im->channels + channel];
            worst = fmax(worst, fabs(a - (double)frame[k * PLANE + i]));
            size = fmax(size, fabs(a));
        }
    }
    return worst / size;
}

static void lights_are_the_light_groups(void) {
    struct tensor_file *f = precompute(grey_sky, "lights", SPP, 3);
    const struct tensor *t = tensor_get(f);
    const struct json *names = json_get(json_get(t->meta, "basis"), "lights");
    float frame[3 * PLANE], weights[3 * 4];
    struct image im;
    traced(grey_sky, SPP, 3, &im);
    CHECK(t->blocks[0].coefficients == 4); // sky, lamp, panel, rest
    for (uint32_t i = 0; i < 3; i++) {
        memset(weights, 0, sizeof weights);
        weights[3 * i] = weights[3 * i + 1] = weights[3 * i + 2] = 1;
        replayed(f, weights, frame, NULL);
        const char *name = json_text(json_at(names, i));
        const double d = layer_difference(&im, name, frame);
        printf("light %s: differs from its layer by %.2g of the brightest\n", name, d);
        CHECK(d < 1e-6);
    }
    replayed(f, t->blocks[0].weights, frame, NULL);
    const double d = layer_difference(&im, "", frame);
    printf("all lights: %.2g\n", d);
    CHECK(d < 1e-6);
    image_finish(&im);
    tensor_close(f);
}

static void grey_cells_are_a_grey_sky(const char *basis) {
    struct tensor_file *f = precompute(grey_sky, basis, SPP, 3);
    float frame[3 * PLANE];
    struct image im;
    traced(grey_sky, SPP, 3, &im);
    replayed(f, tensor_get(f)->blocks[0].weights, frame, NULL);
    const double d = layer_difference(&im, "", frame);
    printf("%s: the same paths differ by %.2g of the brightest\n", basis, d);
    CHECK(d < 2e-6);
    image_finish(&im);
    tensor_close(f);
}

// ---- another lighting ---------------------------------------------------------------------------

enum { COLUMNS = 16, ROWS = 8, REPEATED = 64 };

// An environment of cells, bright in a few places, as a picture large enough that interpolation
// between texels matters little.
static void write_cells(const char *path, const float cells[COLUMNS * ROWS][3]) {
    struct image im;
    CHECK(image_init(&im, COLUMNS * REPEATED, ROWS * REPEATED, 3));
    for (int y = 0; y < im.height; y++)
        for (int x = 0; x < im.width; x++)
            memcpy(im.pixels + 3 * (y * im.width + x),
                   cells[y / REPEATED * COLUMNS + x / REPEATED], sizeof cells[0]);
    CHECK(image_write_exr(path, &im, NULL));
    image_finish(&im);
}

static void make_cells(int turn, float cells[COLUMNS * ROWS][3]) {
    for (int y = 0; y < ROWS; y++)
        for (int x = 0; x < COLUMNS; x++) {
            const int from = (x + turn) % COLUMNS;
            const bool lamp = (from == 3 && y == 1) || (from == 11 && y == 2);
            for (int k = 0; k < 3; k++)
                cells[y * COLUMNS + x][k] = lamp ? 20 - 5 * (float)k : 0.1f * (float)(1 + k);
        }
}

// Compares with path tracing under the same cells. z of the mean over pixels; also the ratio of the
// squared distance to what both errors predict (1 but for chance).
static void compare(const char *environment, const float *frame, const float *variance, double *z,
                    double *ratio) {
    char sky[512], text[8192];
    struct render_result result;
    struct image im;
    snprintf(sky, sizeof sky,
             "<emitter type='envmap'><string name='filename' value='%s'/></emitter>", environment);
    snprintf(text, sizeof text, scene, sky);
    render_text(text, &(struct job_options){.spp = 256, .seed = 99, .variance = true}, &im, &result);
    const int first = image_find_channel(&im, "variance.R");
    double difference = 0, squared = 0, expected = 0, own = 0;
    for (int i = 0; i < PLANE; i++) {
        const float *p = im.pixels + (size_t)i * (size_t)im.channels;
        double d = 0, v = 0;
        for (int k = 0; k < 3; k++) {
            d += ((double)p[k] - (double)frame[k * PLANE + i]) / 3;
            v += (double)p[first + k] / 3;
            squared += pow((double)p[k] - (double)frame[k * PLANE + i], 2) / 3;
        }
        difference += d;
        own += v;
        expected += v + (double)variance[i];
    }
    *z = difference / sqrt(expected);
    *ratio = squared / expected;
    printf("z of the mean %.2f; squared error %.3f of what was told (%.2g of it the reference's)\n", *z,
           *ratio, own / expected);
    image_finish(&im);
}

// Twelve turned environments. The z of one is below 3.9 but for 1 in 10 000 (pixels share the lamp's
// random numbers with nobody: they are independent). The told error is that of 1120 pixels with a
// heavy tail; over all environments its mean is within 20 %.
static void other_lighting_is_as_path_traced(void) {
    enum { TURNS = 12 };
    struct tensor_file *f = precompute(grey_sky, "pixels:16x8", 256, 7);
    float frame[3 * PLANE], variance[PLANE], weights[3 * COLUMNS * ROWS];
    double mean_ratio = 0;
    for (int turn = 0; turn < TURNS; turn++) {
        float cells[COLUMNS * ROWS][3];
        double z, ratio;
        make_cells(turn, cells);
        write_cells(cells_path, cells);
        const struct relight_lighting l = {.environment = cells_path};
        CHECK(relight_weights(tensor_get(f), "t", &l, weights));
        replayed(f, weights, frame, variance);
        compare(cells_path, frame, variance, &z, &ratio);
        CHECK(fabs(z) < 3.9);
        mean_ratio += ratio / TURNS;
    }
    printf("squared error: %.3f of what was told, in the mean\n", mean_ratio);
    CHECK(mean_ratio > 0.8 && mean_ratio < 1.2);
    tensor_close(f);
}

// What rotate means: a picture turned by a cell's width is the picture with its columns moved.
static void rotation_moves_columns(void) {
    struct tensor_file *f = precompute(grey_sky, "pixels:16x8", 2, 1);
    float cells[COLUMNS * ROWS][3], a[3 * COLUMNS * ROWS], b[3 * COLUMNS * ROWS];
    make_cells(0, cells);
    write_cells(cells_path, cells);
    const struct relight_lighting turned = {.environment = cells_path, .rotate = 45};
    CHECK(relight_weights(tensor_get(f), "t", &turned, a));
    make_cells(2, cells);
    write_cells(cells_path, cells);
    const struct relight_lighting moved = {.environment = cells_path};
    CHECK(relight_weights(tensor_get(f), "t", &moved, b));
    double worst = 0;
    for (int i = 0; i < 3 * COLUMNS * ROWS; i++)
        worst = fmax(worst, fabs((double)a[i] - (double)b[i]));
    CHECK(worst < 1e-5);
    tensor_close(f);
}

int main(void) {
    scene_folder_open();
    snprintf(tensor_path, sizeof tensor_path, "%s", scene_path("t.safetensors"));
    snprintf(cells_path, sizeof cells_path, "%s", scene_path("cells.exr"));
    lights_are_the_light_groups();
    grey_cells_are_a_grey_sky("pixels:8x4");
    grey_cells_are_a_grey_sky("haar:8x4");
    grey_cells_are_a_grey_sky("daub4:8x4");
    grey_cells_are_a_grey_sky("sh:3");
    other_lighting_is_as_path_traced();
    rotation_moves_columns();
    scene_folder_close();
    return check_result();
}
