// SPDX-License-Identifier: Apache-2.0
// Editing tensors at the limits of what they take: albedos of 0 and 1, one object, objects that nothing
// sees or that a mirror shows, editable lamps, curves of one bin of 1e6, one bounce, eight bounces, many
// objects. With the same random numbers, the tensor of one set of materials and the weights of another
// give the picture that is traced with that other set (as in edit_paths.c), and it is finite.
#include "capture.h"
#include "render/edit_reference.h"

enum { SIDE = 16, PLANE = SIDE * SIDE };

static char tensor_path[300];

#define EVEN(id, colour)                                                                           \
    "<bsdf type='editable' id='" id "'><string name='model' value='lightview'/>"                   \
    "<rgb name='specular_reflectance' value='" colour "'/></bsdf>"
#define GLOSS(id, exponent, colour)                                                                \
    "<bsdf type='editable' id='" id "'><string name='model' value='blinnphong'/>"                  \
    "<boolean name='fixed_fresnel' value='true'/><float name='exponent' value='" exponent "'/>"    \
    "<rgb name='specular_reflectance' value='" colour "'/></bsdf>"
#define FLOOR                                                                                      \
    "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>"               \
    "<scale value='2'/></transform><ref id='floor'/></shape>"
#define BALL(x, z, id)                                                                             \
    "<shape type='sphere'><point name='center' x='" x "' y='0.5' z='" z "'/>"                      \
    "<float name='radius' value='0.5'/><ref id='" id "'/></shape>"

struct extreme {
    const char *name, *before, *after, *shapes;
};

static const struct extreme extremes[] = {
    {"albedo 0 and from 0", EVEN("floor", "0") EVEN("ball", "0.5"), EVEN("floor", "0.7") EVEN("ball", "0"),
     FLOOR BALL("0", "0", "ball")},
    {"one object", GLOSS("floor", "20", "0.5"), GLOSS("floor", "90", "0.9"), FLOOR},
    {"an object that is never seen", EVEN("floor", "0.5") EVEN("ball", "0.5"),
     EVEN("floor", "0.4") EVEN("ball", "0.9,0.1,0"), FLOOR BALL("0", "6", "ball")},
    {"an object in a mirror only", EVEN("floor", "0.5") EVEN("ball", "0.5")
     "<bsdf type='conductor' id='mirror'/>", EVEN("floor", "0.5") EVEN("ball", "0.9,0.1,0")
     "<bsdf type='conductor' id='mirror'/>", FLOOR BALL("0", "6", "ball")
     "<shape type='rectangle'><transform name='to_world'><scale value='2'/>"
     "<translate y='1' z='-1'/></transform><ref id='mirror'/></shape>"},
    {"a lamp", EVEN("floor", "0.5") EVEN("ball", "0.5"), EVEN("floor", "0.8") EVEN("ball", "0.1,0.9,0"),
     FLOOR "<shape type='sphere'><point name='center' x='0' y='0.5' z='0'/>"
     "<float name='radius' value='0.5'/><ref id='ball'/><emitter type='area'>"
     "<rgb name='radiance' value='3,2,1'/></emitter></shape>"},
    {"one bin of 1e6", GLOSS("floor", "20", "0.5") EVEN("ball", "0.5"),
     "<bsdf type='editable' id='floor'><string name='model' value='blinnphong'/>"
     "<boolean name='fixed_fresnel' value='true'/><string name='edit_a' "
     "value='amplify-y,0,0,90,90,0;translate-y,15,18,18.5,21,1e6'/></bsdf>" EVEN("ball", "1"),
     FLOOR BALL("0", "0", "ball")},
};

static void write_scene(const char *materials, const char *shapes) {
    static char text[65536];
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='path'><integer name='rr_depth' value='1000'/>"
             "</integrator><sensor type='perspective'><float name='fov' value='50'/>"
             "<transform name='to_world'><lookat origin='0.2,1.4,3' target='0,0.5,0' up='0,1,0'/>"
             "</transform><film type='hdrfilm'><integer name='width' value='16'/>"
             "<integer name='height' value='16'/><rfilter type='box'/></film></sensor>%s%s"
             "<emitter type='constant'><rgb name='radiance' value='0.4,0.5,0.6'/></emitter></scene>",
             materials, shapes);
    scene_write("scene.xml", text);
}

// Objects with one factor at later hops; NULL: none.
static const char *group;

static struct polynomial_options options_of(uint32_t bounces, uint32_t second) {
    struct polynomial_options o = {.job = {.scene = scene_path("scene.xml"), .spp = 8, .seed = 5},
                                   .bounces = bounces, .series = {16, second, 1, 1, 1, 1, 1, 1},
                                   .group = &group, .group_count = group != NULL,
                                   .output = tensor_path, .command = "", .version = ""};
    if (bounces == 1)
        o.series[1] = 0;
    return o;
}

static void same_paths(const struct extreme *e, uint32_t bounces, uint32_t second) {
    static double a[3 * PLANE], b[3 * PLANE];
    const struct polynomial_options o = options_of(bounces, second);
    struct polynomial_report report;
    struct edited edited;
    struct polynomial unedited;
    write_scene(e->before, e->shapes);
    if (!precompute_polynomial(&o, &report) || !polynomial_open(&unedited, &o))
        exit(1);
    struct tensor_file *f = tensor_open(tensor_path);
    CHECK(f && tensor_check_values(f));
    write_scene(e->after, e->shapes);
    edited_open_grouped(&edited, &o, tensor_get(f), &unedited.classes);
    edited_contract(&edited, tensor_get(f), false, a);
    plain_trace(&edited.p, &edited.response, (uint32_t)o.job.spp, b);
    double worst = 0, size = 0;
    for (int i = 0; i < 3 * PLANE; i++) {
        CHECK(isfinite(a[i]) && a[i] >= 0);
        worst = fmax(worst, fabs(a[i] - b[i]));
        size = fmax(size, fabs(b[i]));
    }
    printf("%s, %u bounces, second hop %u: differs by %.2g of the brightest, %.3g\n", e->name, bounces,
           second, worst / size, size);
    CHECK(worst < 1e-4 * size && report.rejected == 0);
    polynomial_close(&unedited);
    edited_close(&edited);
    tensor_close(f);
}

// ---- many objects, many bounces ---------------------------------------------------------------

static const char *many_balls(int count, bool edited) {
    static char materials[16384];
    size_t n = (size_t)snprintf(materials, sizeof materials, "%s", EVEN("floor", "0.5"));
    for (int i = 1; i < count; i++)
        n += (size_t)snprintf(materials + n, sizeof materials - n,
                              "<bsdf type='editable' id='b%d'><string name='model' value='lightview'/>"
                              "<rgb name='specular_reflectance' value='%g,%g,0.5'/></bsdf>", i,
                              edited ? 1 - 0.02 * i : 0.5, edited ? 0.03 * i : 0.5);
    return materials;
}

static const char *many_shapes(int count) {
    static char shapes[16384];
    size_t n = (size_t)snprintf(shapes, sizeof shapes, "%s", FLOOR);
    for (int i = 1; i < count; i++)
        n += (size_t)snprintf(shapes + n, sizeof shapes - n,
                              "<shape type='sphere'><point name='center' x='%g' y='0.15' z='%g'/>"
                              "<float name='radius' value='0.15'/><ref id='b%d'/></shape>",
                              0.32 * (i % 8) - 1.2, 0.4 * (i / 8) - 0.8, i);
    return shapes;
}

static void many(int count, uint32_t bounces) {
    static char before[16384];
    struct extreme e = {.name = "many objects", .shapes = many_shapes(count)};
    snprintf(before, sizeof before, "%s", many_balls(count, false));
    e.before = before;
    e.after = many_balls(count, true);
    same_paths(&e, bounces, 1);
}

// 32 objects and 8 bounces make C(39, 7) products: 15 million for each bin of each pixel.
static void too_many(void) {
    const struct polynomial_options o = options_of(8, 1);
    struct polynomial_report report;
    write_scene(many_balls(32, false), many_shapes(32));
    capture_begin();
    const bool done = precompute_polynomial(&o, &report);
    capture_end();
    CHECK(!done && captured_has("1.54e+07 products"));
}

// All balls but the last have one albedo at later hops: 120 products.
static void many_together(void) {
    static char text[1024];
    size_t n = (size_t)snprintf(text, sizeof text, "balls=b1");
    for (int i = 2; i < 31; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, ",b%d", i);
    group = text;
    many(32, 8);
    group = NULL;
}

// ---- a closed room of albedo 1 ----------------------------------------------------------------

static void closed_room(const char *reflectance) {
    char text[2048];
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='path'><integer name='rr_depth' value='1000'/>"
             "</integrator><sensor type='perspective'><float name='fov' value='60'/>"
             "<film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/>"
             "<rfilter type='box'/></film></sensor><shape type='sphere'>"
             "<boolean name='flip_normals' value='true'/><float name='radius' value='2'/>"
             "<bsdf type='editable' id='room'><string name='model' value='lightview'/>"
             "<rgb name='specular_reflectance' value='%s'/></bsdf><emitter type='area'>"
             "<rgb name='radiance' value='1'/></emitter></shape></scene>", reflectance);
    scene_write("scene.xml", text);
}

// The tensor's picture as the scene is: its mean, by channel.
static void mean_picture(enum polynomial_tail tail, double mean[3]) {
    static double a[3 * PLANE];
    struct polynomial_options o = options_of(4, 1);
    struct polynomial_report report;
    struct edited e;
    o.tail = tail;
    o.job.spp = 64;
    if (!precompute_polynomial(&o, &report))
        exit(1);
    struct tensor_file *f = tensor_open(tensor_path);
    edited_open(&e, &o, tensor_get(f));
    edited_contract(&e, tensor_get(f), false, a);
    for (int k = 0; k < 3; k++) {
        mean[k] = 0;
        for (int i = 0; i < PLANE; i++)
            mean[k] += a[k * PLANE + i] / PLANE;
    }
    edited_close(&e);
    tensor_close(f);
}

// Emission 1 and albedo d give 1 + d + ... + d^4, and 1 / (1 - d) with all bounces.
static void rooms(void) {
    const double d[] = {0.9, 0.5, 0.8};
    double mean[3];
    struct polynomial_report report;
    closed_room("1");
    mean_picture(TAIL_NONE, mean);
    printf("albedo 1, 4 bounces: %.4f of 5\n", mean[0]);
    CHECK_NEAR(mean[0], 5, 0.02);
    struct polynomial_options o = options_of(4, 1);
    o.tail = TAIL_GEOMETRIC;
    capture_begin();
    const bool done = precompute_polynomial(&o, &report);
    capture_end();
    CHECK(!done && captured_has("bounce 4 has 1.00"));
    closed_room("0.9,0.5,0.8");
    mean_picture(TAIL_GEOMETRIC, mean);
    for (int k = 0; k < 3; k++) {
        printf("albedo %g, geometric tail: %.4f of %.4f\n", d[k], mean[k], 1 / (1 - d[k]));
        CHECK_NEAR(mean[k] * (1 - d[k]), 1, 0.03);
    }
}

int main(void) {
    scene_folder_open();
    snprintf(tensor_path, sizeof tensor_path, "%s", scene_path("t.safetensors"));
    for (size_t i = 0; i < sizeof extremes / sizeof *extremes; i++) {
        same_paths(&extremes[i], 3, 1);
        same_paths(&extremes[i], 2, 4);
    }
    same_paths(&extremes[0], 1, 0);
    many(4, 8);
    many(32, 3);
    too_many();
    many_together();
    rooms();
    scene_folder_close();
    return check_result();
}
