// SPDX-License-Identifier: Apache-2.0
// pbrt scenes from text: state, transforms, objects, colours, and errors with file and line.
#include "scene_text.h"

#define HEAD "Camera \"perspective\"\nWorldBegin\n"

static struct scene *read_pbrt(const char *text) {
    const struct scene_options options = scene_real_options();
    scene_write("scene.pbrt", text);
    capture_begin();
    struct scene *s = scene_read(scene_path("scene.pbrt"), &options);
    capture_end();
    return s;
}

static void keeps_its_state(void) {
    struct scene *s = read_pbrt(
        "Film \"rgb\" \"integer xresolution\" [ 200 ] \"integer yresolution\" 100\n" HEAD
        "Translate 1 2 3\nAttributeBegin\nScale 2 2 2 Shape \"sphere\"\nAttributeEnd\n"
        "ReverseOrientation Shape \"sphere\" # a comment\n");
    CHECK(s && s->shape_count == 2 && s->film.width == 200 && s->film.height == 100);
    if (!s)
        return;
    const struct transform *a = &s->shapes[0].to_world, *b = &s->shapes[1].to_world;
    CHECK(a->m[0][0] == 2 && b->m[0][0] == 1 && a->m[2][3] == b->m[2][3]);
    CHECK(!s->shapes[0].flip_normals && s->shapes[1].flip_normals);
    CHECK(PARAM(int, s->integrator, "max_depth") == 6);
    CHECK(strcmp(s->shapes[0].bsdf->type->name, "twosided") == 0);
    scene_destroy(s);
}

static void names_its_sampler(void) {
    struct scene *s = read_pbrt("Sampler \"halton\" " HEAD);
    CHECK(s && captured_has("scene.pbrt:1: sampler \"halton\" is read as \"sobol\""));
    scene_destroy(s);
    s = read_pbrt("Sampler \"sobol\" " HEAD);
    CHECK(s && !captured_has("is read as"));
    scene_destroy(s);
}

static void places_objects(void) {
    struct scene *s = read_pbrt(
        HEAD "Translate 5 0 0\nObjectBegin \"o\" Translate 0 1 0 Shape \"disk\" ObjectEnd\n"
        "ObjectInstance \"o\"\nIdentity ObjectInstance \"o\"\nObjectBegin \"none\" ObjectEnd\n"
        "ObjectInstance \"none\"");
    CHECK(s && s->instance_count == 2 && s->shape_count == 1 && s->group_count == 2);
    CHECK(s && s->instances[0].to_world.m[0][3] - s->instances[1].to_world.m[0][3] == 5);
    scene_destroy(s);
}

static void reads_meshes_and_colours(void) {
    struct scene *s = read_pbrt(
        HEAD "Material \"diffuse\" \"rgb reflectance\" [ 0.1 0.2 0.3 ]\n"
        "AreaLightSource \"diffuse\" \"blackbody L\" 5000 \"float scale\" 3\n"
        "Shape \"trianglemesh\" \"point P\" [ 0 0 0 1 0 0 0 1 0 ]\n"
        "LightSource \"point\" \"point3 from\" [ 1 2 3 ] \"float power\" 12.566370614359172\n");
    CHECK(s && s->shapes[0].mesh.triangle_count == 1 && s->light_count == 2);
    if (!s)
        return;
    const struct texture_ref light = PARAM(struct texture_ref, s->lights[0].object, "radiance");
    CHECK_NEAR(spectrum_luminance(light.value), 3, 1e-5);
    CHECK(light.value[0] > light.value[2]);
    check_colour(PARAM(spectrum, s->lights[1].object, "intensity"), 1, 1, 1, 1e-6);
    scene_destroy(s);
}

// Parameters of Attribute stand in for those that are not given.
static void gives_parameters(void) {
    struct scene *s = read_pbrt(
        HEAD "AttributeBegin Attribute \"material\" \"float roughness\" 0.25\n"
        "Attribute \"shape\" \"float radius\" 3\nMaterial \"conductor\"\nShape \"sphere\"\n"
        "Shape \"sphere\" \"float radius\" 2\nAttributeEnd\nShape \"sphere\"");
    CHECK(s && s->shape_count == 3);
    const double radii[3] = {3, 2, 1};
    for (uint32_t i = 0; s && i < 3; i++)
        CHECK(s->shapes[i].to_world.m[0][0] == radii[i]);
    if (s) {
        const struct object *metal = PARAM(const struct object *, s->shapes[0].bsdf, "front");
        CHECK(strcmp(metal->type->name, "roughconductor") == 0);
        CHECK_NEAR(PARAM(struct texture_ref, metal, "alpha").value[0], 0.5, 1e-6); // its root
    }
    scene_destroy(s);
}

// A coat of 1.4 over gold: the metal meets the coat's index; alpha is the root of a roughness.
static void coats_metals(void) {
    struct scene *s = read_pbrt(
        HEAD "Material \"coatedconductor\" \"spectrum conductor.eta\" \"metal-Au-eta\"\n"
        "\"spectrum conductor.k\" \"metal-Au-k\" \"float conductor.roughness\" 0.09\n"
        "\"float interface.eta\" 1.4 \"float interface.roughness\" 0.04\nShape \"sphere\"\n"
        "Material \"coatedconductor\" \"rgb reflectance\" [ 0.2 0.5 0.8 ]\nShape \"sphere\"");
    CHECK(s && s->shape_count == 2);
    if (!s)
        return;
    const struct object *coat = PARAM(const struct object *, s->shapes[0].bsdf, "front");
    CHECK(strcmp(coat->type->name, "coated") == 0);
    CHECK_NEAR(PARAM(float, coat, "int_ior"), 1.4, 1e-6);
    CHECK_NEAR(PARAM(struct texture_ref, coat, "alpha").value[0], 0.2, 1e-6);
    const struct object *metal = PARAM(const struct object *, coat, "bsdf");
    CHECK(strcmp(metal->type->name, "roughconductor") == 0);
    CHECK_NEAR(PARAM(struct texture_ref, metal, "alpha").value[0], 0.3, 1e-6);
    CHECK_NEAR(PARAM(float, metal, "ext_eta"), 1.4, 1e-6);
    const struct object *smooth = PARAM(const struct object *, s->shapes[1].bsdf, "front");
    CHECK_NEAR(PARAM(float, smooth, "int_ior"), 1.5, 1e-6);
    CHECK(PARAM(struct texture_ref, smooth, "alpha").value[0] == 0);
    metal = PARAM(const struct object *, smooth, "bsdf");
    CHECK(strcmp(metal->type->name, "conductor") == 0);
    scene_destroy(s);
}

static void says_what_is_wrong(void) {
    static const struct {
        const char *text, *message;
    } bad[] = {
        {"", "before WorldBegin"},
        {"WorldBegin", "has no Camera"},
        {HEAD "Shap \"sphere\"", "scene.pbrt:3: found 'Shap', expected a directive; did you mean \"Shape\"?"},
        {HEAD "Shape \"spere\"", "scene.pbrt:3: Shape \"spere\" is not known; did you mean \"sphere\"?"},
        {HEAD "Shape \"curve\"", "is not read"},
        {HEAD "Shape sphere", "found 'sphere', expected a type in quotes"},
        {HEAD "Shape \"sphere\" \"float radius\" [ 1", "found 'end of file'"},
        {HEAD "Shape \"sphere\" \"float radius\" \"one\"", "found 'one\"'"},
        {HEAD "Shape \"sphere\" \"flot radius\" 1", "\"flot\" is not a type"},
        {HEAD "Shape \"sphere\" \"rgb radius\" [ 1 1 1 ]", "is of the type rgb, expected float"},
        {HEAD "Shape \"sphere\" \"float phimax\" 90", "only whole spheres"},
        {HEAD "Shape \"sphere\" \"string radius", "does not end in its line"},
        {HEAD "\n\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 ] \"integer indices\" [ 0 1 2 ]",
         "scene.pbrt:5: Shape \"trianglemesh\": an index"},
        {HEAD "NamedMaterial \"x\"", "there is no material \"x\""},
        {HEAD "Material \"diffuse\" \"texture reflectance\" \"t\"", "no spectrum texture \"t\""},
        {HEAD "ObjectInstance \"o\"", "there is no object \"o\""},
        {HEAD "AttributeEnd", "was not begun"},
        {HEAD "AttributeBegin", "inside a block"},
        {HEAD "Include \"none.pbrt\"", "none.pbrt"},
        {HEAD "Include \"scene.pbrt\"", "Camera stands after WorldBegin"},
        {HEAD "Translate 1 2", "expected 3 numbers of Translate"},
        {HEAD "Scale 1 0 1 Shape \"sphere\"", "no inverse"},
        {HEAD "ConcatTransform [1 0 0 0  0 1 0 0  0 0 1 1  0 0 0 0]", "0 0 1 0, expected 0 0 0 1"},
        {HEAD "Rotate 1 0 0 0", "no length"},
        {HEAD "MediumInterface \"m\" \"\" Shape \"sphere\"", "there is no medium \"m\""},
        {HEAD "Material \"conductor\" \"spectrum eta\" [ 500 1 400 1 ] \"spectrum k\" [ 500 1 ]",
         "ascending"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct scene *s = read_pbrt(bad[i].text);
        CHECK(!s);
        if (!captured_has(bad[i].message))
            printf("%zu: %s\n", i, bad[i].message);
        CHECK(captured_has(bad[i].message));
        scene_destroy(s);
    }
    struct scene *s = read_pbrt(HEAD "Shape \"sphere\" \"float ratius\" 2\n");
    CHECK(s && captured_has("\"ratius\" is not used"));
    scene_destroy(s);
}

int main(void) {
    scene_folder_open();
    keeps_its_state();
    names_its_sampler();
    places_objects();
    reads_meshes_and_colours();
    gives_parameters();
    coats_metals();
    says_what_is_wrong();
    scene_folder_close();
    return check_result();
}
