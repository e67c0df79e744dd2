// SPDX-License-Identifier: Apache-2.0
// Colours, spectra, numbers and transforms of scene files.
#include "math/colour.h"
#include "scene_text.h"

static spectrum reflectance_of(const char *value) {
    char body[2048];
    snprintf(body, sizeof body, "<bsdf type='diffuse' id='b'>%s</bsdf>", value);
    struct scene *s = scene_parse(body);
    CHECK(s);
    if (!s) {
        printf("%s\n%s", body, captured);
        return spectrum_grey(-1);
    }
    const spectrum c = PARAM(struct texture_ref, s->bsdfs[0], "reflectance").value;
    scene_destroy(s);
    return c;
}

static spectrum intensity_of(const char *value) {
    char body[2048];
    snprintf(body, sizeof body, "<emitter type='point'>%s</emitter>", value);
    struct scene *s = scene_parse(body);
    CHECK(s);
    if (!s) {
        printf("%s\n%s", body, captured);
        return spectrum_grey(-1);
    }
    const spectrum c = PARAM(spectrum, s->lights[0].object, "intensity");
    scene_destroy(s);
    return c;
}

static void reflectances(void) {
    check_colour(reflectance_of("<rgb name='reflectance' value='.1 .2 .3'/>"), .1, .2, .3, 1e-7);
    check_colour(reflectance_of("<rgb name='reflectance' value='.1, .2,.3'/>"), .1, .2, .3, 1e-7);
    check_colour(reflectance_of("<rgb name='reflectance' value='.4'/>"), .4, .4, .4, 1e-7);
    check_colour(reflectance_of("<float name='reflectance' value='.4'/>"), .4, .4, .4, 1e-7);
    check_colour(reflectance_of("<rgb name='reflectance' value='#ff0080'/>"), 1, 0, 128 / 255.0,
                 1e-7);
    check_colour(reflectance_of("<srgb name='reflectance' value='#ff0080'/>"), 1, 0, 0.2158605,
                 1e-6);
    check_colour(reflectance_of("<spectrum name='reflectance' value='.3'/>"), .3, .3, .3, 1e-7);
    check_colour(
        reflectance_of("<spectrum name='reflectance' value='400:0, 500:.1, 600:.6, 700:.9'/>"),
        0.77751607, 0.30252782, 0.012683385, 1e-6);
    check_colour(reflectance_of("<spectrum name='reflectance' type='irregular'>"
                                "<string name='wavelengths' value='400, 500, 600, 700'/>"
                                "<string name='values' value='0, .1, .6, .9'/></spectrum>"),
                 0.77751607, 0.30252782, 0.012683385, 1e-6);
    check_colour(reflectance_of("<spectrum name='reflectance' type='regular'>"
                                "<float name='wavelength_min' value='400'/>"
                                "<float name='wavelength_max' value='700'/>"
                                "<string name='values' value='0 .1 .6 .9'/></spectrum>"),
                 0.77751607, 0.30252782, 0.012683385, 1e-6);
    scene_write("red.spd", "# red\n400 0\n500 .1 # a comment\r\n\n600 .6\n700 .9");
    check_colour(reflectance_of("<spectrum name='reflectance' filename='red.spd'/>"), 0.77751607,
                 0.30252782, 0.012683385, 1e-6);
    // outside the gamut: clamped to it
    const spectrum green = reflectance_of("<spectrum name='reflectance' value='500:1, 510:1'/>");
    check_colour(green, 0, 0.0781108, 0.0146232, 1e-6);
}

static void emissions(void) {
    check_colour(intensity_of("<float name='intensity' value='3'/>"), 3, 3, 3, 1e-6);
    check_colour(intensity_of("<rgb name='intensity' value='3 2 1'/>"), 3, 2, 1, 1e-6);
    check_colour(intensity_of("<spectrum name='intensity' value='3'/>"), 3.6143818, 2.844873,
                 2.7267482, 1e-5);
    check_colour(
        intensity_of("<spectrum name='intensity' value='400:0, 500:8, 600:15.6, 700:18.4'/>"),
        20.710836, 10.854634, 2.771152, 1e-5);
    check_colour(intensity_of("<spectrum name='intensity' type='d65'/>"), 1, 1, 1, 1e-6);
    check_colour(intensity_of("<spectrum name='intensity' type='d65'><float name='scale' "
                              "value='2'/><rgb name='color' value='.1 .2 .3'/></spectrum>"),
                 .2, .4, .6, 1e-6);
    check_colour(intensity_of("<spectrum name='intensity' type='uniform'>"
                              "<float name='value' value='2'/></spectrum>"), 2, 2, 2, 1e-6);
    const spectrum hot = colour_blackbody(5000);
    check_colour(intensity_of("<spectrum name='intensity' type='blackbody'>"
                              "<float name='temperature' value='5000'/>"
                              "<float name='scale' value='1e-3'/></spectrum>"),
                 hot[0] / 1e3, hot[1] / 1e3, hot[2] / 1e3, 1e-4);
    check_colour(intensity_of("<blackbody name='intensity' temperature='5000K' scale='1e-3'/>"),
                 hot[0] / 1e3, hot[1] / 1e3, hot[2] / 1e3, 1e-4);
    struct scene *s = scene_parse("<spectrum type='uniform' id='lamp'>"
                                  "<float name='value' value='7'/></spectrum>"
                                  "<emitter type='point'><ref id='lamp' name='intensity'/></emitter>");
    CHECK(s);
    if (s)
        check_colour(PARAM(spectrum, s->lights[0].object, "intensity"), 7, 7, 7, 1e-6);
    scene_destroy(s);
}

// Where a vertex of a unit square goes.
static void check_transform(const char *steps, double x, double y, double z) {
    char body[1024];
    snprintf(body, sizeof body, "<shape type='sphere'><transform name='to_world'>%s</transform>"
             "</shape>", steps);
    struct scene *s = scene_parse(body);
    CHECK(s);
    if (!s) {
        printf("%s\n%s", steps, captured);
        return;
    }
    const double p[3] = {1, 2, 3};
    double q[3];
    transform_point(&s->shapes[0].to_world, p, q);
    CHECK_NEAR(q[0] + s->centre[0], x, 1e-12);
    CHECK_NEAR(q[1] + s->centre[1], y, 1e-12);
    CHECK_NEAR(q[2] + s->centre[2], z, 1e-12);
    scene_destroy(s);
}

static void transforms(void) {
    check_transform("", 1, 2, 3);
    check_transform("<translate x='1'/>", 2, 2, 3);
    check_transform("<translate value='1, 2, 3'/>", 2, 4, 6);
    check_transform("<scale value='2'/>", 2, 4, 6);
    check_transform("<scale x='2' z='-1'/>", 2, 2, -3);
    check_transform("<rotate z='1' angle='90'/>", -2, 1, 3);
    check_transform("<rotate value='0 0 1' angle='90'/>", -2, 1, 3);
    check_transform("<scale value='2'/><translate x='1'/>", 3, 4, 6);  // in order of the file
    check_transform("<translate x='1'/><scale value='2'/>", 4, 4, 6);
    check_transform("<matrix value='0 1 0 5 1 0 0 6 0 0 2 7 0 0 0 1'/>", 7, 7, 13);
    check_transform("<matrix value='0 1 0 1 0 0 0 0 2'/>", 2, 1, 6);
    check_transform("<matrix value='2 0 0 2 0 2 0 0 0 0 2 0 0 0 1e-9 2'/>", 2, 2, 3);
    // the view's left is +x: looking along +x with z up, x of the camera is +y of the world
    check_transform("<lookat origin='10 0 0' target='11 0 0' up='0 0 1'/>", 13, 1, 2);
}

static void scalars(void) {
    struct scene *s = scene_parse("<bsdf type='dielectric'><string name='int_ior' value='diamond'/>"
                                  "<float name='ext_ior' value='1.25'/></bsdf>"
                                  "<bsdf type='roughconductor'><integer name='alpha' value='1'/>"
                                  "<string name='distribution' value='ggx'/></bsdf>"
                                  "<integrator type='path'><integer name='max_depth' value=' 7 '/>"
                                  "</integrator>");
    CHECK(s);
    if (!s)
        return;
    CHECK_NEAR(PARAM(float, s->bsdfs[0], "int_ior"), 2.419, 1e-6);
    CHECK_NEAR(PARAM(float, s->bsdfs[0], "ext_ior"), 1.25, 1e-6);
    CHECK(PARAM(int, s->integrator, "max_depth") == 7);
    scene_destroy(s);
}

int main(void) {
    scene_folder_open();
    reflectances();
    emissions();
    transforms();
    scalars();
    scene_folder_close();
    return check_result();
}
