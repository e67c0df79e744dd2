// SPDX-License-Identifier: Apache-2.0
// Precomputed materials under direct light: closed forms, error against the number of bins and of
// lights, points against triangles, extremes.
#include "edit_picture.h"
#include "scene_text.h"
#include "transport/tensor.h"

static const char *scene_of(const char *camera, const char *light, const char *material,
                            const char *shape) {
    char text[8192];
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='path'/>%s"
             "<film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='12'/>"
             "<rfilter type='box'/></film></sensor>%s<bsdf type='editable' id='m'>%s</bsdf>%s</scene>",
             camera, light, material, shape);
    scene_write("e.xml", text);
    return scene_path("e.xml");
}

static const char ABOVE[] = "<sensor type='orthographic'><transform name='to_world'>"
                            "<lookat origin='0,5,0' target='0,0,0' up='0,0,1'/></transform>";
static const char ASIDE[] = "<sensor type='perspective'><float name='fov' value='25'/>"
                            "<transform name='to_world'><lookat origin='0,3,6' target='0,0,0' up='0,1,0'/>"
                            "</transform>";
static const char EVEN[] = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
static const char SKY[] = "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>";
static const char FLOOR[] = "<shape type='rectangle'><transform name='to_world'><scale value='9'/>"
                            "<rotate x='1' angle='-90'/></transform><ref id='m'/></shape>";
static const char BALL[] = "<shape type='sphere'><ref id='m'/></shape>";

static struct edit_options options_of(uint32_t triangles) {
    return (struct edit_options){.job = {.spp = 2, .threads = 2}, .lights = triangles, .light_samples = 2};
}

// The coefficients of the first pixel of block 0, first channel.
static uint32_t first_pixel(double *out) {
    struct tensor_file *f = tensor_open(scene_path("e.xml.safetensors"));
    const struct tensor_block *b = &tensor_get(f)->blocks[0];
    const uint32_t n = b->coefficients;
    for (uint32_t j = 0; j < n; j++)
        out[j] = (double)((const float *)b->values)[(size_t)j * 3 * TENSOR_LANES];
    tensor_close(f);
    return n;
}

static double square(double x) {
    return x * x;
}

// The sum is pi; T over theta_i is pi (sin^2 g1 - sin^2 g0), over theta_h seen along the normal the
// same with twice the angles, up to pi / 4 (Ben-Artzi 2007 with unit quotient, uniform light).
static void agrees_with_closed_forms(void) {
    static const char *const gammas[] = {"theta_i", "theta_h"};
    for (int kind = 0; kind < 2; kind++) {
        double sums[2] = {0}, worst = 0;
        for (int k = 0; k < 2; k++) {
            const int bins = k ? 256 : 16;
            char material[256];
            double T[256];
            struct edit_picture p;
            snprintf(material, sizeof material,
                     "<string name='model' value='freehand'/><string name='gamma_a' value='%s'/>"
                     "<string name='basis' value='box'/><integer name='bins' value='%d'/>", gammas[kind],
                     bins);
            const struct edit_options o = options_of(4000);
            CHECK(edit_picture_by_tensor(scene_of(ABOVE, EVEN, material, FLOOR), &o, false, &p, NULL));
            edit_picture_free(&p);
            first_pixel(T);
            for (int j = 0; j < bins; j++) {
                const double scale = kind ? 2 : 1, end = M_PI / 2;
                const double g0 = fmin(scale * j * M_PI / 2 / bins, end),
                             g1 = fmin(scale * (j + 1) * M_PI / 2 / bins, end);
                const double expected = M_PI * (square(sin(g1)) - square(sin(g0)));
                sums[k] += T[j];
                worst = fmax(worst, k ? 0 : fabs(T[j] - expected));
            }
        }
        printf("%s: sum %.6f and %.6f (pi), 16 bins off by at most %.2g\n", gammas[kind], sums[0], sums[1],
               worst);
        CHECK_NEAR(sums[0], M_PI, 2e-3 * M_PI);
        CHECK_NEAR(sums[1], sums[0], 1e-5 * sums[0]);
        CHECK(worst < 0.01 * M_PI);
    }
}

// Rows of a matrix with all ones for the second curve are the vector of the first, columns with all
// ones for the first that of the second, whatever triangles bend over either angle (A9).
static void matrices_sum_to_vectors(void) {
    enum { ROWS = 64, COLUMNS = 32 };
    static const char THETA_H[] = "<string name='gamma_a' value='theta_h'/><integer name='bins' value='64'/>";
    static const char THETA_D[] = "<string name='gamma_a' value='theta_d'/><integer name='bins' value='32'/>";
    static const char BOTH[] = "<string name='gamma_b' value='theta_d'/><integer name='bins_b' value='32'/>";
    static double T[3][ROWS * COLUMNS];
    for (int hat = 0; hat < 2; hat++) {
        double worst = 0, sums[2][ROWS] = {{0}};
        for (int k = 0; k < 3; k++) {
            char material[400];
            struct edit_picture p;
            const struct edit_options o = options_of(1000);
            snprintf(material, sizeof material, "<string name='model' value='freehand'/>"
                     "<string name='basis' value='%s'/>%s%s", hat ? "hat" : "box",
                     k == 1 ? THETA_D : THETA_H, k == 2 ? BOTH : "");
            CHECK(edit_picture_by_tensor(scene_of(ASIDE, SKY, material, FLOOR), &o, false, &p, NULL));
            edit_picture_free(&p);
            first_pixel(T[k]);
        }
        for (int i = 0; i < ROWS * COLUMNS; i++) {
            sums[0][i / COLUMNS] += T[2][i];
            sums[1][i % COLUMNS] += T[2][i];
        }
        for (int k = 0; k < 2; k++) {
            double most = 0;
            for (int i = 0; i < (k ? COLUMNS : ROWS); i++)
                most = fmax(most, T[k][i]);
            for (int i = 0; i < (k ? COLUMNS : ROWS); i++)
                worst = fmax(worst, fabs(sums[k][i] - T[k][i]) / most);
        }
        printf("sums of a matrix of %s: %.1e of the largest off\n", hat ? "hats" : "boxes", worst);
        CHECK(worst <= 1e-5);
    }
}

static void picture(const char *basis, int bins, double exponent, const struct edit_options *o,
                    struct edit_picture *p) {
    char material[400];
    snprintf(material, sizeof material,
             "<float name='exponent' value='%g'/><boolean name='fixed_fresnel' value='true'/>"
             "<string name='basis' value='%s'/><integer name='bins' value='%d'/>", exponent, basis, bins);
    CHECK(edit_picture_by_tensor(scene_of(ASIDE, SKY, material, BALL), o, false, p, NULL));
}

// Under smooth light the root of relMSE falls with the square of the number of bins, as the light
// that a boxed curve reflects does, down to the error of the shares.
static void falls_with_bins(void) {
    const struct edit_options o = options_of(1000);
    static const char *const bases[] = {"box", "hat"};
    struct edit_picture truth, p;
    edit_picture_write_sun(scene_path("sky.exr"), 0, false);
    picture("hat", 2048, 64, &o, &truth);
    for (int b = 0; b < 2; b++) {
        double first = 0, last = 0;
        printf("relMSE against bins 8 to 512, %s:", bases[b]);
        for (int bins = 8; bins <= 512; bins *= 2) {
            picture(bases[b], bins, 64, &o, &p);
            const double e = edit_picture_relmse(&p, &truth);
            printf(" %.2g", e);
            first = bins == 8 ? e : first;
            last = bins == 32 ? e : last;
            edit_picture_free(&p);
        }
        const double slope = 0.5 * log(last / first) / log(4);
        printf(" (root: slope %.2f from 8 to 32)\n", slope);
        CHECK_NEAR(slope, -2, 0.25);
    }
    edit_picture_free(&truth);
}

// Error falls with lights, and is several times that for as many points (a sharp highlight, n = 1024,
// under a small bright lamp).
static void falls_with_lights(void) {
    static const uint32_t counts[] = {100, 400, 1000, 4000, 16000};
    struct edit_options o = options_of(64000);
    struct edit_picture truth, p;
    double error[2][5];
    edit_picture_write_sun(scene_path("sky.exr"), 200, false);
    picture("hat", 512, 1024, &o, &truth);
    for (int points = 0; points < 2; points++) {
        printf("relMSE against lights 100 to 16000, %s:", points ? "points" : "triangles");
        o.as_points = points;
        for (int i = 0; i < 5; i++) {
            o.lights = counts[i];
            picture("hat", 512, 1024, &o, &p);
            error[points][i] = edit_picture_relmse(&p, &truth);
            printf(" %.2g", error[points][i]);
            CHECK(i == 0 || points || error[0][i] < error[0][i - 1]);
            edit_picture_free(&p);
        }
        printf("\n");
    }
    for (int i = 0; i < 3; i++)
        CHECK(error[1][i] > 4 * error[0][i]);
    edit_picture_free(&truth);
}

static uint32_t most_urgent(const struct light_triangles *t) {
    uint32_t best = 0;
    double most = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        const struct light_triangle *l = &t->items[i];
        const double urgency = (l->power[0] + l->power[1] + l->power[2]) *
                               sqrt(sqrt(fmin(l->solid_angle, 0.01)));
        best = urgency > most ? i : best;
        most = fmax(urgency, most);
    }
    return best;
}

// A part of a triangle of constant radiance.
static struct light_triangle part_of(const struct light_triangle *whole, struct direction a,
                                     struct direction b, struct direction c) {
    struct light_triangle t = {.corner = {a, b, c},
                               .centre = direction_of(a.x + b.x + c.x, a.y + b.y + c.y, a.z + b.z + c.z)};
    t.solid_angle = solid_angle_within(t.corner);
    for (int i = 0; i < 3; i++)
        t.power[i] = whole->power[i] * t.solid_angle / whole->solid_angle;
    return t;
}

// Splits triangles of constant radiance as light/light_triangles.h has it.
static void split_lights(struct light_triangles *t, uint32_t most) {
    struct light_triangle *l = mem_array(most, sizeof *l);
    memcpy(l, t->items, t->count * sizeof *l);
    mem_free(t->items);
    t->items = l;
    for (; t->count + 3 <= most; t->count += 3) {
        const uint32_t i = most_urgent(t);
        const struct light_triangle whole = l[i];
        const struct direction *c = whole.corner;
        struct direction m[3];
        for (int k = 0; k < 3; k++)
            m[k] = direction_of(c[k].x + c[(k + 1) % 3].x, c[k].y + c[(k + 1) % 3].y,
                                c[k].z + c[(k + 1) % 3].z);
        l[i] = part_of(&whole, m[0], m[1], m[2]);
        for (int k = 0; k < 3; k++)
            l[t->count + (uint32_t)k] = part_of(&whole, c[k], m[k], m[(k + 2) % 3]);
    }
}

// What the shape of lights is worth, apart from how finely they follow the sky (Ben-Artzi 2007, figure
// 4.3): under a sky that is constant over each of 400 triangles these triangles err at least ten times
// less than 100, 1000 or 10 000 points of the same sky, though the last lie nearer to each other than
// this highlight is wide.
static void beats_points_under_the_same_light(void) {
    static const uint32_t counts[] = {100, 1000, 10000};
    struct edit_options o = options_of(400);
    struct light_triangles sky, few;
    struct edit_picture truth, p, exact;
    o.job.spp = 1; // one position sees all lights
    picture("hat", 512, 1024, &o, &p);
    o.tolerance = 1e-5;
    picture("hat", 512, 1024, &o, &exact);
    const char *scene = scene_path("e.xml");
    edit_picture_lights(scene, &o, &sky);
    edit_picture_by_lights(scene, &o, &sky, 3, true, &truth);
    o.lights = counts[0]; // fewer cells have the light of the same sky
    edit_picture_lights(scene, &o, &few);
    const double triangles = edit_picture_relmse(&p, &truth), least = edit_picture_relmse(&exact, &truth);
    printf("relMSE under the same sky: 400 triangles %.2g (%.2g with exact shares); points 100 to 10 000:",
           triangles, least);
    edit_picture_free(&p);
    for (int i = 0; i < 3; i++) {
        if (i > 0)
            split_lights(&sky, counts[i]);
        edit_picture_by_lights(scene, &o, i > 0 ? &sky : &few, 0, true, &p);
        const double points = edit_picture_relmse(&p, &truth);
        printf(" %.2g", points);
        CHECK(points >= 10 * triangles && triangles < 1.2 * least);
        edit_picture_free(&p);
    }
    printf("\n");
    light_triangles_finish(&sky);
    light_triangles_finish(&few);
    edit_picture_free(&exact);
    edit_picture_free(&truth);
}

static void check_extreme(const char *what, const char *camera, const char *material,
                          const char *shape, const int crop[4]) {
    struct edit_options o = options_of(400);
    struct edit_picture p;
    double least = 0;
    memcpy(o.job.crop, crop, sizeof o.job.crop);
    CHECK(edit_picture_by_tensor(scene_of(camera, SKY, material, shape), &o, true, &p, NULL));
    for (int i = 0; i < 3 * p.width * p.height; i++) {
        CHECK(isfinite(p.rgb[i]));
        least = fmin(least, p.rgb[i]);
    }
    printf("%s: mean %.3g, least %.2g\n", what, edit_picture_mean(&p), least);
    CHECK(least >= 0);
    edit_picture_free(&p);
}

static void survives_extremes(void) {
    static const int all[4] = {0}, one[4] = {8, 6, 9, 7};
    static const char LEVEL[] = "<sensor type='perspective'><float name='fov' value='0.005'/>"
                                "<transform name='to_world'><lookat origin='0,0.000873,5' target='0,0,0'"
                                " up='0,1,0'/></transform>";
    edit_picture_write_sun(scene_path("sky.exr"), 1e6, false);
    check_extreme("a texel of 1e6", ASIDE, "", BALL, all);
    check_extreme("one pixel", ASIDE, "", BALL, one);
    check_extreme("a pixel that shows nothing", ASIDE, "", BALL, (const int[4]){0, 0, 1, 1});
    check_extreme("1 bin", ASIDE, "<integer name='bins' value='1'/><string name='basis' value='box'/>"
                  "<boolean name='fixed_fresnel' value='true'/>", BALL, all);
    check_extreme("4096 bins", ASIDE, "<integer name='bins' value='4096'/>"
                  "<boolean name='fixed_fresnel' value='true'/>", BALL, one);
    check_extreme("exponent 1e5", ASIDE, "<float name='exponent' value='1e5'/>", BALL, all);
    check_extreme("black", ASIDE, "<rgb name='specular_reflectance' value='0'/>", BALL, all);
    check_extreme("89.99 degrees", LEVEL, "<string name='model' value='cooktorrance'/>", FLOOR, all);
    edit_picture_write_sun(scene_path("sky.exr"), 0, true);
    check_extreme("light below the horizon", ASIDE, "", FLOOR, all);
}

int main(void) {
    scene_folder_open();
    edit_picture_write_sun(scene_path("sky.exr"), 0, false);
    agrees_with_closed_forms();
    matrices_sum_to_vectors();
    falls_with_bins();
    falls_with_lights();
    beats_points_under_the_same_light();
    survives_extremes();
    scene_folder_close();
    return check_result();
}
