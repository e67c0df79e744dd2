// SPDX-License-Identifier: Apache-2.0
// The error that relume verify states of pictures at the limits of what materials and skies may be is
// the true one: against path tracing of other seeds. What triangles of the sky cannot carry is in it: a
// lobe far narrower than a triangle (exponent 1e5: 0.2 degrees), and a grazing view, where quotients change
// over a triangle whose centre alone they are taken at. Half-sums tell of sampled lights only.
//
// Both errors come from traces of their own, with standard errors from the spread over blocks of pixels:
// they may differ by four of these (Student's t of 11 degrees at the worst: false alarms 2e-3 each, 2e-2
// for all ten, once per choice of seeds).
#include "driver/verify.h"
#include "edit_picture.h"
#include "render/picture.h"

enum { WIDTH = 16, HEIGHT = 12, SIDE = 4, BLOCKS = WIDTH / SIDE * (HEIGHT / SIDE) };

static const char ASIDE[] = "<float name='fov' value='25'/><transform name='to_world'>"
                            "<lookat origin='0,3,6' target='0,0,0' up='0,1,0'/></transform>";
static const char LEVEL[] = "<float name='fov' value='0.005'/><transform name='to_world'>"
                            "<lookat origin='0,0.000873,5' target='0,0,0' up='0,1,0'/></transform>";
static const char FLOOR[] = "<shape type='rectangle'><transform name='to_world'><scale value='9'/>"
                            "<rotate x='1' angle='-90'/></transform><ref id='m'/></shape>";
static const char BALL[] = "<shape type='sphere'><ref id='m'/></shape>";

#define ONE_CURVE "<boolean name='fixed_fresnel' value='true'/>"
#define BINS(n, basis) "<integer name='bins' value='" n "'/><string name='basis' value='" basis "'/>"

enum sky_kind { EVEN, TEXEL, BELOW };

struct limit {
    const char *name;
    enum sky_kind sky;
    const char *camera, *material, *shape;
    double most; // relMSE
};

static const struct limit limits[] = {
    {"nothing special", EVEN, ASIDE, ONE_CURVE, BALL, 1e-2},
    {"a texel of 1e6", TEXEL, ASIDE, "", BALL, 1e-2},
    {"one bin", EVEN, ASIDE, ONE_CURVE BINS("1", "box"), BALL, 1e-2},
    {"4096 bins", EVEN, ASIDE, ONE_CURVE BINS("4096", "hat"), BALL, 1e-2},
    {"all curves zero", EVEN, ASIDE, "<rgb name='specular_reflectance' value='0'/>", BALL, 1e-6},
    {"light below the horizon", BELOW, ASIDE, "", FLOOR, 1e-6},
    {"exponent 1e5", EVEN, ASIDE, "<float name='exponent' value='1e5'/>", BALL, INFINITY},
    {"exponent 1e5, a texel of 1e6", TEXEL, ASIDE, "<float name='exponent' value='1e5'/>", BALL, INFINITY},
    {"89.99 degrees", EVEN, LEVEL, "<string name='model' value='cooktorrance'/>", FLOOR, 1},
    {"89.99 degrees, a texel of 1e6", TEXEL, LEVEL, "<string name='model' value='cooktorrance'/>", FLOOR,
     INFINITY},
};

static const char *write_scene(const struct limit *l) {
    char text[4096];
    edit_picture_write_sun(scene_path("sky.exr"), l->sky == TEXEL ? 1e6 : 0, l->sky == BELOW);
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'>%s"
             "<film type='hdrfilm'><integer name='width' value='%d'/><integer name='height' value='%d'/>"
             "<rfilter type='box'/></film></sensor>"
             "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>"
             "<bsdf type='editable' id='m'>%s</bsdf>%s</scene>", l->camera, WIDTH, HEIGHT, l->material,
             l->shape);
    scene_write("l.xml", text);
    return scene_path("l.xml");
}

static void trace(const char *scene, uint32_t seed, struct image *im) {
    struct render_result result;
    render_file(scene, &(struct job_options){.spp = full_mode() ? 1024 : 256, .seed = seed, .threads = 2,
                                             .max_depth = 2}, im, &result);
}

// relMSE of the picture, without the noise of the two traces, and its standard error.
static struct measured error_of(const struct edit_picture *p, const struct image *a,
                                const struct image *b) {
    double block[BLOCKS] = {0}, sum = 0, squares = 0;
    const double mean = edit_picture_mean(p), floor = 1e-3 * mean * mean;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int k = 0; k < 3; k++) {
            const double v = p->rgb[3 * i + k], scale = v * v + floor;
            const double x = v - (double)a->pixels[i * a->channels + k],
                         y = v - (double)b->pixels[i * b->channels + k];
            block[i / WIDTH / SIDE * (WIDTH / SIDE) + i % WIDTH / SIDE] +=
                scale > 0 ? x * y / scale / (3 * SIDE * SIDE) : 0;
        }
    for (int i = 0; i < BLOCKS; i++) {
        sum += block[i];
        squares += block[i] * block[i];
    }
    return (struct measured){sum / BLOCKS,
                             sqrt(fmax(squares - sum * sum / BLOCKS, 0) / (BLOCKS - 1) / BLOCKS)};
}

static void is_told(const struct limit *l) {
    char tensor[320], scene[300];
    struct edit_picture p;
    struct image a, b;
    struct verify_result r;
    snprintf(scene, sizeof scene, "%s", write_scene(l));
    snprintf(tensor, sizeof tensor, "%s.safetensors", scene);
    const struct edit_options o = {.job = {.threads = 2}, .lights = 4000, .light_samples = 2};
    CHECK(edit_picture_by_tensor(scene, &o, true, &p, NULL));
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        CHECK(isfinite(p.rgb[i]) && p.rgb[i] >= 0);
    trace(scene, 11, &a);
    trace(scene, 12, &b);
    const struct measured true_error = error_of(&p, &a, &b);
    const struct verify_options v = {.job = {.scene = scene, .threads = 2, .seed = 5, .spp = 256},
                                     .tensor = tensor, .pixels = WIDTH * HEIGHT, .no_device = true};
    CHECK(verify_edit(&v, &r));
    const double error = sqrt(true_error.error * true_error.error + r.relmse_error * r.relmse_error / 4);
    printf("%s: relMSE %.2g +- %.1g, told %.2g +- %.1g; %+.2f %% too bright\n", l->name, true_error.mean,
           true_error.error, r.relmse, r.relmse_error / 2, r.bias * 100);
    CHECK(fabs(r.relmse - true_error.mean) <= 4 * error + 1e-6);
    CHECK(true_error.mean < l->most + 4 * true_error.error);
    edit_picture_free(&p);
    image_finish(&a);
    image_finish(&b);
}

int main(void) {
    scene_folder_open();
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i += full_mode() ? 1 : 4)
        is_told(&limits[i]);
    scene_folder_close();
    return check_result();
}
