// SPDX-License-Identifier: Apache-2.0
// Light on the texels and at the vertices of a mesh: against closed forms, and tensors of them
// against pictures from the same random numbers.
#include "driver/precompute_relight.h"
#include "render/picture.h"
#include "render/ztable.h"
#include "replay/relight.h"
#include "replay/replay.h"

static const double FALSE_ALARMS = 1e-3;

// A lamp of intensity 3 at (0.3, -0.2, 0.7) over the square [-1, 1]^2 at z = 0, looking up.
#define LAMP                                                                                       \
    "<emitter type='point'><point name='position' x='0.3' y='-0.2' z='0.7'/>"                      \
    "<rgb name='intensity' value='3'/></emitter>"

static double lamp_on(double x, double y) {
    const double dx = x - 0.3, dy = y + 0.2, d2 = dx * dx + dy * dy + 0.49;
    return 3 * 0.7 / (d2 * sqrt(d2));
}

static void render_on(const char *scene, const struct receiver *receiver, int size, int spp,
                      struct image *im) {
    char text[4096];
    struct render_result result;
    snprintf(text, sizeof text, "<scene version='3.0.0'><integrator type='path'/>"
             "<sensor type='perspective'><film type='hdrfilm'/></sensor>%s</scene>", scene);
    const struct job_options o = {.receiver = *receiver, .spp = spp, .variance = true,
                                  .reading = {.width = size, .height = size}};
    render_text(text, &o, im, &result);
}

// Mean over all texels of value times one of 1, u, v, which a mirrored or turned map would change.
static struct measured moment_of(const struct image *im, int which) {
    struct measured m = {0, 0};
    const double n = (double)im->width * im->height;
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++) {
            const float *p = pixel_at(im, x, y);
            const double w = which == 1 ? (x + 0.5) / im->width : which ? (y + 0.5) / im->height : 1;
            m.mean += w * (double)p[0] / n;
            m.error += w * w * (double)p[image_find_channel(im, "variance.R")] / (n * n);
        }
    m.error = sqrt(m.error);
    return m;
}

static double lamp_moment(int size, int which) {
    enum { STEPS = 512 };
    double sum = 0;
    for (int j = 0; j < STEPS; j++)
        for (int i = 0; i < STEPS; i++) {
            const double u = (i + 0.5) / STEPS, v = (j + 0.5) / STEPS;
            const double w = which == 1 ? (floor(u * size) + 0.5) / size
                             : which ? (floor(v * size) + 0.5) / size : 1;
            sum += w * lamp_on(2 * u - 1, 2 * v - 1) / (STEPS * STEPS);
        }
    return sum;
}

static void texels_see_the_lamp(void) {
    static const char *const names[] = {"mean", "mean times u", "mean times v"};
    struct image im;
    render_on("<shape type='rectangle' id='floor'/>" LAMP, &(struct receiver){.texels = "floor"}, 16,
              full_mode() ? 4096 : 256, &im);
    CHECK(im.width == 16 && im.height == 16);
    for (int which = 0; which < 3; which++)
        ztable_add(names[which], lamp_moment(16, which), moment_of(&im, which), 1e-6);
    image_finish(&im);
}

// A square whose texture coordinates fill [0.22, 0.77]^2 of the map.
static void write_chart(void) {
    scene_write("chart.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0.22 0.22\nvt 0.77 0.22\n"
                             "vt 0.77 0.77\nvt 0.22 0.77\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n");
}

// Under a sky of 1 all that has mesh has irradiance pi, borders too, and the rest is 0.
static void borders_are_not_darkened(void) {
    struct image im;
    int lit = 0;
    double worst = 0;
    write_chart();
    render_on("<shape type='obj' id='chart'><string name='filename' value='chart.obj'/></shape>"
              "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>",
              &(struct receiver){.texels = "chart"}, 16, 256, &im);
    for (int i = 0; i < 256; i++) {
        const bool inside = i % 16 >= 3 && i % 16 < 13 && i / 16 >= 3 && i / 16 < 13;
        const double e = (double)im.pixels[i * im.channels];
        CHECK(inside || e == 0);
        lit += inside;
        worst = inside ? fmax(worst, fabs(e / M_PI - 1)) : worst;
    }
    printf("chart of %d texels under a uniform sky: worst off by %.2g\n", lit, worst);
    CHECK(worst < 0.02); // noise of 256 samples
    image_finish(&im);
}

// Nothing is random in a lamp's light at a point.
static void vertices_see_the_lamp(void) {
    struct image im;
    write_chart();
    render_on("<shape type='obj' id='chart'><string name='filename' value='chart.obj'/></shape>" LAMP,
              &(struct receiver){.vertices = "chart"}, 0, 16, &im);
    CHECK(im.width == RECEIVER_ROW && im.height == 1);
    const double x[] = {-1, 1, 1, -1}, y[] = {-1, -1, 1, 1};
    for (int i = 0; i < 4; i++)
        CHECK_NEAR(im.pixels[i * im.channels] / lamp_on(x[i], y[i]), 1, 1e-5);
    for (int i = 4; i < RECEIVER_ROW; i++)
        CHECK(im.pixels[i * im.channels] == 0);
    image_finish(&im);
}

static const char room[] =
    "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='4'/></integrator>"
    "<sensor type='perspective'><film type='hdrfilm'/></sensor><shape type='rectangle' id='floor'/>"
    "<shape type='sphere'><point name='center' x='0.2' y='0' z='0.5'/><float name='radius' value='0.3'/>"
    "</shape>" LAMP "<emitter type='constant'/></scene>";

// The tensor's weights at 1 give the picture.
static void tensors_are_the_picture(const struct receiver *receiver) {
    struct image im;
    struct job job;
    struct render_result result;
    struct relight_report report;
    char path[300];
    scene_write("scene.xml", room);
    snprintf(path, sizeof path, "%s", scene_path("t.safetensors"));
    const struct job_options o = {.scene = scene_path("scene.xml"), .receiver = *receiver, .spp = 16,
                                  .reading = {.width = 12, .height = 12}};
    if (!job_open(&job, &o))
        exit(1);
    job.render.tracer.replicates = 2; // as the tensor's halves
    struct film *film = job_render(&job, &result);
    CHECK(job_image(&job, film, &result, &im));
    film_destroy(film);
    job_close(&job);
    const struct relight_options relight = {.job = o, .basis = "lights", .output = path,
                                            .command = "", .version = ""};
    CHECK(precompute_relight(&relight, &report));
    struct tensor_file *f = tensor_open(path);
    const struct tensor *t = tensor_get(f);
    const size_t plane = (size_t)im.width * (size_t)im.height;
    float *frame = mem_array(3 * plane, sizeof *frame);
    struct replay *r = replay_create(t, &(struct replay_options){.no_device = true});
    CHECK(t->width == (uint32_t)im.width && t->height == (uint32_t)im.height);
    CHECK(replay_product(r, 0, t->blocks[0].weights) && replay_frame(r, NULL, frame));
    double worst = 0;
    for (size_t i = 0; i < plane; i++)
        worst = fmax(worst, fabs((double)(im.pixels[i * (size_t)im.channels] - frame[i])));
    printf("%s: tensor and picture differ by %.2g\n", receiver->texels ? "texels" : "vertices", worst);
    CHECK(worst < 1e-5);
    replay_destroy(r);
    mem_free(frame);
    tensor_close(f);
    image_finish(&im);
}

static void wrong_names_are_told(void) {
    struct job job;
    scene_write("scene.xml", room);
    capture_begin();
    const struct job_options o = {.scene = scene_path("scene.xml"), .receiver = {.texels = "flor"}};
    CHECK(!job_open(&job, &o));
    capture_end();
    CHECK(captured_has("the nearest is floor"));
}

int main(void) {
    scene_folder_open();
    texels_see_the_lamp();
    borders_are_not_darkened();
    vertices_see_the_lamp();
    tensors_are_the_picture(&(struct receiver){.texels = "floor"});
    tensors_are_the_picture(&(struct receiver){.vertices = "floor"});
    wrong_names_are_told();
    ztable_finish(FALSE_ALARMS);
    scene_folder_close();
    return check_result();
}
