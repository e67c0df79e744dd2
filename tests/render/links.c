// SPDX-License-Identifier: Apache-2.0
// Shapes that the camera does not see, and lights that light some shapes only: against closed forms.
#include "render/picture.h"
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;
static const double PI_2 = 6.283185307179586;
static const double FLOOR_Z = 5 - 0.01; // from the near plane

static const char *const methods[] = {"path", "volpath", "direct", "simple", "dipole"};
enum { METHODS = sizeof methods / sizeof *methods };

// Looks from (0, 0, 5) down to z = 0, where it sees [-size, size]^2.
static void draw(const char *method, double size, int spp, const char *body, struct image *im) {
    char text[8192];
    struct render_result result;
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='%s'/><sensor type='orthographic'>"
             "<transform name='to_world'><scale x='%g' y='%g'/><lookat origin='0,0,5' target='0,0,0' "
             "up='0,1,0'/></transform><film type='hdrfilm'><string name='pixel_format' value='rgba'/>"
             "<rfilter type='box'/></film></sensor>%s</scene>", method, size, size, body);
    const struct job_options o = {.spp = spp, .variance = true, .aovs = "Z",
                                  .reading = {.width = 8, .height = 8}};
    render_text(text, &o, im, &result);
}

// Whether all pixels of the columns [x0, x1) have that value.
static void expect_value(const char *what, const struct image *im, const char *channel, int x0,
                         int x1, double value) {
    const int c = image_find_channel(im, channel);
    double worst = 0;
    for (int y = 0; y < im->height && c >= 0; y++)
        for (int x = x0; x < x1; x++)
            worst = fmax(worst, fabs((double)pixel_at(im, x, y)[c] - value));
    printf("%-50s %s is %g within %.2g\n", what, channel, value, worst);
    CHECK(c >= 0 && worst <= 4e-7 * fmax(fabs(value), 0));
}

// Columns [x0, x1) of a picture with its variances.
static struct measured mean_of(const struct image *im, int x0, int x1) {
    const int r = image_find_channel(im, "R"), v = image_find_channel(im, "variance.R");
    const double n = (double)(x1 - x0) * im->height;
    struct measured m = {0, 0};
    for (int y = 0; y < im->height; y++)
        for (int x = x0; x < x1; x++) {
            m.mean += (double)pixel_at(im, x, y)[r] / n;
            m.error += (double)pixel_at(im, x, y)[v] / (n * n);
        }
    m.error = sqrt(m.error);
    return m;
}

#define HIDE "<boolean name='visible_to_camera' value='false'/>"
#define LIFT(z) "<transform name='to_world'><translate z='" z "'/></transform>"
#define DOWN "<vector name='direction' x='0' y='0' z='-1'/>"
#define FLOOR "<shape type='rectangle'><bsdf type='diffuse'/></shape>"

// ---- the camera's rays --------------------------------------------------------------------------

static void camera_looks_through(void) {
    static const char *const hidden[] = {
        "<shape type='rectangle'>" HIDE LIFT("1") "</shape>",
        "<shape type='rectangle'>" HIDE LIFT("1") "</shape><shape type='cube'>" HIDE "</shape>",
        "<shape type='sphere'>" HIDE "<float name='radius' value='2'/></shape>",
        "<shape type='shapegroup' id='g'><shape type='cube'>" HIDE "</shape></shape>"
        "<shape type='instance'><ref id='g'/></shape>",
        "<shape type='shapegroup' id='g'><shape type='sphere'/></shape>"
        "<shape type='instance'>" HIDE "<ref id='g'/></shape>"};
    for (int i = 0; i < (int)(sizeof hidden / sizeof *hidden); i++)
        for (int m = 0; m < METHODS; m++) {
            char body[2048];
            struct image im;
            snprintf(body, sizeof body, "<shape type='rectangle'><emitter type='area'>"
                     "<rgb name='radiance' value='2'/></emitter></shape>%s", hidden[i]);
            draw(methods[m], 0.9, 4, body, &im);
            expect_value(methods[m], &im, "R", 0, 8, 2);
            if (strcmp(methods[m], "simple") != 0) { // it knows colours only
                expect_value(methods[m], &im, "A", 0, 8, 1);
                expect_value(methods[m], &im, "Z", 0, 8, FLOOR_Z);
            }
            image_finish(&im);
        }
}

// What is hidden still casts shadows, and stands in mirrors.
static void others_meet_it(void) {
    struct image im;
    draw("path", 0.5, 4, FLOOR "<emitter type='directional'>" DOWN "</emitter>"
         "<shape type='disk'>" HIDE LIFT("1") "</shape>", &im);
    expect_value("shadow of a hidden disk", &im, "R", 0, 8, 0);
    expect_value("shadow of a hidden disk", &im, "Z", 0, 8, FLOOR_Z);
    image_finish(&im);
    draw("path", 0.5, 4, "<shape type='rectangle'><bsdf type='conductor'><string name='material' "
         "value='none'/></bsdf></shape><shape type='rectangle'>" HIDE "<boolean name='flip_normals' "
         "value='true'/>" LIFT("1") "<emitter type='area'><rgb name='radiance' value='3'/></emitter>"
         "</shape>", &im);
    expect_value("hidden lamp in a mirror", &im, "R", 0, 8, 3);
    image_finish(&im);
}

static void lights_can_be_hidden(void) {
    for (int m = 0; m < METHODS; m++) {
        struct image im;
        const char *sky = "<emitter type='constant'>" HIDE "</emitter>";
        char body[1024];
        draw(methods[m], 0.9, 4, sky, &im);
        expect_value("hidden sky", &im, "R", 0, 8, 0);
        expect_value("hidden sky", &im, "A", 0, 8, 0);
        image_finish(&im);
        snprintf(body, sizeof body, FLOOR "%s", sky);
        draw(methods[m], 0.9, 64, body, &im);
        ztable_add("floor under a hidden sky", 0.5, mean_of(&im, 0, 8), 1e-6);
        image_finish(&im);
        // a disk of radius 1 one above: pi / 2, of which half is sent on over pi
        draw(methods[m], 1e-4, 64, FLOOR "<shape type='disk'><transform name='to_world'>"
             "<rotate x='1' angle='180'/><translate z='1'/></transform><emitter type='area'>" HIDE
             "<rgb name='radiance' value='1'/></emitter></shape>", &im);
        ztable_add("floor under a hidden lamp", 0.25, mean_of(&im, 0, 8), 1e-6);
        image_finish(&im);
    }
}

// ---- which light lights what --------------------------------------------------------------------

#define HALF(id, x, bsdf)                                                                          \
    "<shape type='rectangle' id='" id "'><string name='group' value='" id " half'/>"               \
    "<transform name='to_world'><scale x='0.5'/><translate x='" x "'/></transform>" bsdf "</shape>"
#define HALVES HALF("left", "-0.5", "<bsdf type='diffuse'/>") HALF("right", "0.5", "<bsdf type='diffuse'/>")

static void lists_of_suns(void) {
    static const char *const lists[] = {"<string name='exclude' value='right'/>",
                                        "<string name='exclude' value=' right half , right'/>",
                                        "<string name='include' value='left'/>",
                                        "<string name='include' value='left half'/>"};
    for (int i = 0; i < 4; i++)
        for (int m = 0; m < METHODS; m++) {
            char body[2048];
            struct image im;
            snprintf(body, sizeof body, HALVES "<emitter type='directional'>" DOWN "%s"
                     "<rgb name='irradiance' value='1'/></emitter><emitter type='directional'>" DOWN
                     "<rgb name='irradiance' value='2'/></emitter>", lists[i]);
            draw(methods[m], 0.9, 256, body, &im);
            ztable_add(lists[i], 3 / PI_2, mean_of(&im, 0, 4), 1e-6);
            ztable_add(lists[i], 2 / PI_2, mean_of(&im, 4, 8), 1e-6);
            image_finish(&im);
        }
}

// Lights that materials find too: what is sampled either way counts nothing.
static void lists_under_mis(void) {
    static const char *const found[] = {
        "<emitter type='constant'>%s</emitter>",
        "<shape type='sphere'><point name='center' x='0' y='0' z='9'/><float name='radius' value='2'/>"
        "<emitter type='area'>%s<rgb name='radiance' value='3'/></emitter></shape>"};
    const char *const halves[] = {
        HALVES, HALF("left", "-0.5", "<bsdf type='diffuse'/>") HALF("right", "0.5", "<bsdf type='roughconductor'/>"),
        HALF("left", "-0.5", "<bsdf type='diffuse'/>") HALF("right", "0.5", "<bsdf type='conductor'/>")};
    for (int h = 0; h < 3; h++)
        for (int i = 0; i < 2; i++)
            for (int m = 0; m < METHODS; m++) {
                char light[512], body[4096];
                struct image with, without;
                snprintf(light, sizeof light, found[i], "<string name='exclude' value='right'/>");
                snprintf(body, sizeof body, "%s%s", halves[h], light);
                draw(methods[m], 0.9, 32, body, &with);
                snprintf(light, sizeof light, found[i], "");
                snprintf(body, sizeof body, "%s%s", halves[h], light);
                draw(methods[m], 0.9, 32, body, &without);
                expect_value("right of a light that excludes it", &with, "R", 4, 8, 0);
                for (int p = 0; p < 64; p++)
                    if (p % 8 < 4)
                        CHECK(pixel_at(&with, p % 8, p / 8)[0] == pixel_at(&without, p % 8, p / 8)[0]);
                CHECK(mean_of(&without, 4, 8).mean > 0);
                image_finish(&with);
                image_finish(&without);
            }
}

// Sixteen lamps, which a tree chooses among; odd ones leave the floor out.
static void lists_in_a_tree(void) {
    char body[8192] = "<shape type='rectangle' id='floor'/>";
    double sum = 0;
    struct image im;
    for (int i = 0; i < 16; i++) {
        const double x = i % 4 - 1.5, y = i / 4 - 1.5, d2 = x * x + y * y + 1;
        const size_t n = strlen(body);
        snprintf(body + n, sizeof body - n, "<emitter type='point'><point name='position' x='%g' y='%g' "
                 "z='1'/>%s</emitter>", x, y,
                 i % 2 ? "<string name='exclude' value='floor'/>" : "");
        sum += i % 2 ? 0 : 1 / (d2 * sqrt(d2)) / PI_2;
    }
    draw("path", 1e-4, 1024, body, &im);
    ztable_add("sixteen lamps, eight of them linked", sum, mean_of(&im, 0, 8), 1e-6);
    image_finish(&im);
}

int main(void) {
    scene_folder_open();
    camera_looks_through();
    others_meet_it();
    lights_can_be_hidden();
    lists_of_suns();
    lists_under_mis();
    lists_in_a_tree();
    scene_folder_close();
    ztable_finish(FALSE_ALARMS);
    return check_result();
}
