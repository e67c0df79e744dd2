// SPDX-License-Identifier: Apache-2.0
// How true edited pictures are: a Cornell box with glossy floor and back wall, its materials edited in a
// tensor, against path tracing of the edited scene with its materials whole and as many bounces. Prints
// relMSE without noise: differences from two independent references are multiplied, and what the
// half-sums tell of the tensor's noise is taken off.
//
// Holds: the order of Figs 5.3, 5.5 and 5.6 of Ben-Artzi 2007, and errors of (128,8) and (128,1).
#include "render/edit_reference.h"

enum { MOST_SIDE = 64, MOST_PLANE = MOST_SIDE * MOST_SIDE };

static int side = 24, tensor_spp = 128, reference_spp = 512;

// Exponents and colours of floor, back wall, and the boxes' colours.
struct edit {
    const char *name, *floor, *back, *left, *small, *tall;
};

#define BLINN(id, exponent, specular, diffuse)                                                     \
    "<bsdf type='twosided' id='" id "'><bsdf type='editable'>"                                     \
    "<string name='model' value='blinnphong'/><boolean name='fixed_fresnel' value='true'/>"        \
    "<float name='exponent' value='" exponent "'/><rgb name='specular_reflectance' value='"        \
    specular "'/><rgb name='diffuse_reflectance' value='" diffuse "'/></bsdf></bsdf>"
#define EVEN(id, colour)                                                                           \
    "<bsdf type='twosided' id='" id "'><bsdf type='editable'><string name='model' "                \
    "value='lightview'/><rgb name='specular_reflectance' value='" colour "'/></bsdf></bsdf>"

static const struct edit edits[] = {
    {"as it was", BLINN("floor", "20", "0.4", "0.4"), BLINN("back", "10", "0.3", "0.4"),
     EVEN("left", "0.63,0.065,0.05"), EVEN("small", "0.7"), EVEN("tall", "0.7")},
    {"glossy back wall", BLINN("floor", "20", "0.4", "0.4"), BLINN("back", "100", "0.8", "0.1"),
     EVEN("left", "0.63,0.065,0.05"), EVEN("small", "0.7"), EVEN("tall", "0.7")},
    {"yellow box, sharp floor", BLINN("floor", "120", "0.7,0.6,0.5", "0.1"),
     BLINN("back", "10", "0.3", "0.4"), EVEN("left", "0.63,0.065,0.05"), EVEN("small", "0.8,0.7,0.1"),
     EVEN("tall", "0.7")},
    {"all at once", BLINN("floor", "60", "0.3,0.6,0.7", "0.3,0.1,0.05"),
     BLINN("back", "80", "0.7,0.5,0.2", "0.1,0.2,0.3"), EVEN("left", "0.1,0.2,0.7"),
     EVEN("small", "0.2,0.7,0.3"), EVEN("tall", "0.9,0.3,0.1")},
};

static char tensor_path[300];

static void write_scene(const struct edit *e) {
    char text[16384];
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='path'><integer name='rr_depth' value='100'/>"
             "</integrator><sensor type='perspective'><float name='fov' value='39'/>"
             "<transform name='to_world'><lookat origin='0,1,3.9' target='0,1,0' up='0,1,0'/>"
             "</transform><film type='hdrfilm'><integer name='width' value='%d'/>"
             "<integer name='height' value='%d'/><rfilter type='box'/></film></sensor>%s%s%s%s%s"
             EVEN("rest", "0.7")
             "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>"
             "</transform><ref id='floor'/></shape>"
             "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/>"
             "<translate y='2'/></transform><ref id='rest'/></shape>"
             "<shape type='rectangle'><transform name='to_world'><translate y='1' z='-1'/></transform>"
             "<ref id='back'/></shape>"
             "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='90'/>"
             "<translate x='-1' y='1'/></transform><ref id='left'/></shape>"
             "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='-90'/>"
             "<translate x='1' y='1'/></transform><ref id='rest'/></shape>"
             "<shape type='cube'><transform name='to_world'><scale value='0.3'/>"
             "<rotate y='1' angle='20'/><translate x='0.4' y='0.3' z='0.4'/></transform>"
             "<ref id='small'/></shape>"
             "<shape type='cube'><transform name='to_world'><scale x='0.3' y='0.6' z='0.3'/>"
             "<rotate y='1' angle='-20'/><translate x='-0.35' y='0.6' z='-0.3'/></transform>"
             "<ref id='tall'/></shape>"
             "<shape type='rectangle'><transform name='to_world'><scale value='0.35'/>"
             "<rotate x='1' angle='90'/><translate y='1.99'/></transform><emitter type='area'>"
             "<rgb name='radiance' value='17,12,4'/></emitter></shape></scene>",
             side, side, e->floor, e->back, e->left, e->small, e->tall);
    scene_write("scene.xml", text);
}

// ---- errors -----------------------------------------------------------------------------------

// halves: (a - b) / 2 of the picture's two estimates; NULL: it has no noise of its own.
static double error_of(const double *picture, const double *halves, const double *p, const double *q) {
    const int n = 3 * side * side;
    double mean = 0, sum = 0;
    for (int i = 0; i < n; i++)
        mean += 0.5 * (p[i] + q[i]) / n;
    for (int i = 0; i < n; i++) {
        const double truth = 0.5 * (p[i] + q[i]);
        const double own = halves ? halves[i] * halves[i] : 0;
        sum += ((picture[i] - p[i]) * (picture[i] - q[i]) - own) / (truth * truth + 1e-3 * mean * mean);
    }
    return sum / n;
}

static struct polynomial_options options_of(const uint32_t *series, uint32_t bounces, uint32_t seed) {
    struct polynomial_options o = {.job = {.scene = scene_path("scene.xml"), .spp = tensor_spp,
                                           .seed = seed}, .bounces = bounces, .output = tensor_path,
                                   .command = "", .version = ""};
    for (uint32_t i = 0; i < bounces; i++)
        o.series[i] = series[i];
    return o;
}

struct pictures {
    double truth[2][3 * MOST_PLANE], flat[2][3 * MOST_PLANE], work[3 * MOST_PLANE];
};

// The edited scene with whole materials; and with Lambertian ones for light of two bounces.
static void trace_truth(const struct edit *edit, uint32_t bounces, struct pictures *out) {
    const uint32_t series[EDIT_MOST_BOUNCES] = {1024, 1, 1, 1, 1};
    write_scene(edit);
    for (uint32_t i = 0; i < 2; i++) {
        struct polynomial_options o = options_of(series, bounces, 50 + i);
        struct polynomial p;
        if (!polynomial_open(&p, &o))
            exit(1);
        plain_trace(&p, NULL, (uint32_t)reference_spp, out->truth[i]);
        polynomial_close(&p);
    }
}

// A series' picture of every edit, and its error.
static void measure_series(const uint32_t *series, uint32_t bounces, enum polynomial_later later,
                           double *errors, struct pictures *truth,
                           double (*direct)[3 * MOST_PLANE]) {
    static double picture[3 * MOST_PLANE], halves[3 * MOST_PLANE];
    struct polynomial_options o = options_of(series, bounces, 7);
    struct polynomial_report report;
    o.later = later;
    write_scene(&edits[0]);
    if (!precompute_polynomial(&o, &report))
        exit(1);
    struct tensor_file *f = tensor_open(tensor_path);
    printf("(%u,%u) %u bounces, %s, %.0f MB:", series[0], bounces > 1 ? series[1] : 0, bounces,
           polynomial_laters[later], (double)report.file_bytes * 1e-6);
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        struct edited e;
        write_scene(&edits[i]);
        edited_open(&e, &o, tensor_get(f));
        edited_contract(&e, tensor_get(f), false, picture);
        edited_contract(&e, tensor_get(f), true, halves);
        errors[i] = error_of(picture, halves, truth[i].truth[0], truth[i].truth[1]);
        if (direct)
            memcpy(direct[i], picture, sizeof picture);
        printf(" %.2e", errors[i]);
        edited_close(&e);
    }
    printf("\n");
    tensor_close(f);
}

// Full direct light, and Lambertian surfaces for all that was reflected before (the series that the
// source rejects).
static void measure_flat(double (*direct)[3 * MOST_PLANE], struct pictures *truth, double *errors) {
    const uint32_t series[EDIT_MOST_BOUNCES] = {128, 1};
    const struct polynomial_options o = options_of(series, 2, 21);
    struct tensor_file *f = tensor_open(tensor_path); // for the albedos
    printf("direct light, diffuse indirect:");
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        static double two[3 * MOST_PLANE], one[3 * MOST_PLANE];
        struct edited e;
        write_scene(&edits[i]);
        edited_open(&e, &o, tensor_get(f));
        e.flat = true;
        plain_trace(&e.p, &e.response, (uint32_t)reference_spp, two);
        e.p.path.max_depth = 2;
        plain_trace(&e.p, &e.response, (uint32_t)reference_spp, one);
        for (int k = 0; k < 3 * side * side; k++)
            two[k] += direct[i][k] - one[k];
        errors[i] = error_of(two, NULL, truth[i].truth[0], truth[i].truth[1]);
        printf(" %.2e", errors[i]);
        edited_close(&e);
    }
    printf("\n");
    tensor_close(f);
}

static double mean_of(const double *errors) {
    double sum = 0;
    for (size_t i = 1; i < sizeof edits / sizeof *edits; i++) // of what was edited
        sum += errors[i];
    return sum / (double)(sizeof edits / sizeof *edits - 1);
}

static void two_bounces(void) {
    enum { COUNT = sizeof edits / sizeof *edits };
    static struct pictures truth[COUNT];
    static double direct[COUNT][3 * MOST_PLANE];
    double e128_8[COUNT], e16_8[COUNT], e128_1[COUNT], e128[COUNT], flat[COUNT], kept[COUNT], terms[COUNT];
    for (size_t i = 0; i < COUNT; i++)
        trace_truth(&edits[i], 2, &truth[i]);
    measure_series((const uint32_t[]){128}, 1, LATER_LAMBERTIAN, e128, truth, direct);
    measure_series((const uint32_t[]){16, 8}, 2, LATER_LAMBERTIAN, e16_8, truth, NULL);
    measure_series((const uint32_t[]){128, 8}, 2, LATER_LAMBERTIAN, e128_8, truth, NULL);
    measure_series((const uint32_t[]){128, 1}, 2, LATER_LAMBERTIAN, e128_1, truth, NULL);
    measure_series((const uint32_t[]){128, 1}, 2, LATER_KEPT, kept, truth, NULL);
    measure_series((const uint32_t[]){128, 1}, 2, LATER_TERMS, terms, truth, NULL);
    measure_flat(direct, truth, flat);
    CHECK(mean_of(e128_8) < mean_of(e16_8));
    CHECK(mean_of(e128_8) < mean_of(e128_1));
    CHECK(mean_of(e128_1) < mean_of(flat));
    CHECK(mean_of(flat) < mean_of(e128));
    CHECK(mean_of(e128_8) < 2e-3);
    CHECK(mean_of(terms) < 1e-2);          // 2.5e-3
    CHECK(mean_of(terms) < mean_of(kept)); // 1.02e-2 +- 0.01e-2 at 32x32: beyond 1e-2
    CHECK(mean_of(kept) < mean_of(e128_1));
    CHECK(mean_of(e128_1) < 4e-2); // 2.5e-2
}

static void four_bounces(void) {
    enum { COUNT = sizeof edits / sizeof *edits };
    static struct pictures truth[COUNT];
    double e[COUNT];
    for (size_t i = 0; i < COUNT; i++)
        trace_truth(&edits[i], 4, &truth[i]);
    measure_series((const uint32_t[]){64, 1, 1, 1}, 4, LATER_LAMBERTIAN, e, truth, NULL);
    CHECK(mean_of(e) < 4e-2);
}

int main(void) {
    scene_folder_open();
    snprintf(tensor_path, sizeof tensor_path, "%s", scene_path("t.safetensors"));
    if (full_mode()) { // two minutes of one core
        side = 32;
        tensor_spp = 1024;
        reference_spp = 2048;
    }
    two_bounces();
    if (full_mode())
        four_bounces();
    scene_folder_close();
    return check_result();
}
