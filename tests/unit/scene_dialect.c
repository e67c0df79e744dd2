// SPDX-License-Identifier: Apache-2.0
// Several files, variables, aliases, and the names of versions before 2.
#include <sys/stat.h>

#include "math/ior.h"
#include "scene_text.h"

static void variables(void) {
    const struct scene_define defines[] = {{"spp", "32"}};
    struct scene_options options = scene_real_options();
    const char *text = "<scene version='3.0.0'><default name='spp' value='4'/>"
                       "<default name='w' value='64'/><default name='width' value='$w'/>"
                       "<sensor type='perspective'><sampler type='independent'>"
                       "<integer name='sample_count' value='$spp'/></sampler><film type='hdrfilm'>"
                       "<integer name='width' value='$width'/>"
                       "<integer name='height' value='1${w}'/></film></sensor></scene>";
    char plain[1024];
    snprintf(plain, sizeof plain, "%s", text);
    memcpy(strstr(plain, "1${w}"), "1$w  ", 5); // "$w" inside other text
    struct scene *s = scene_parse_with(&options, plain);
    CHECK(s && s->sample_count == 4 && s->film.width == 64 && s->film.height == 164);
    scene_destroy(s);
    options.defines = defines;
    options.define_count = 1;
    s = scene_parse_with(&options, plain);
    CHECK(s && s->sample_count == 32);
    scene_destroy(s);
    CHECK(!scene_parse_with(&options, text));
    CHECK(captured_has("scene.xml:1: $ is not defined"));
}

static void unused_variable(void) {
    const struct scene_define defines[] = {{"sppp", "32"}};
    struct scene_options options = scene_real_options();
    options.defines = defines;
    options.define_count = 1;
    CHECK(!scene_parse_with(&options, "<scene version='3.0.0'><default name='spp' value='4'/>"
                                      "<sensor type='perspective'/></scene>"));
    CHECK(captured_has("nothing uses -D sppp=32; did you mean spp?"));
    CHECK(!scene_parse("<bsdf type='$materiel'/>"));
    CHECK(captured_has("scene.xml:2: $materiel is not defined"));
    struct scene *s = scene_parse("<shape type='cube' id='a\\$b'/>");
    CHECK(s && strcmp(s->shapes[0].name, "a$b") == 0);
    scene_destroy(s);
}

static void includes(void) {
    mkdir(scene_path("part"), 0777);
    mkdir(scene_path("lib"), 0777);
    scene_write("part/a.xml", "<scene version='3.0.0'><include filename='b.xml'/>"
                              "<bsdf type='diffuse' id='red'><rgb name='reflectance' "
                              "value='$r 0 0'/></bsdf></scene>");
    scene_write("part/b.xml", "<scene version='3.0.0'><default name='r' value='.5'/></scene>");
    scene_write("lib/object.xml", "<bsdf version='3.0.0' type='diffuse' id='object'/>");
    struct scene *s = scene_parse("<path value='lib'/><include filename='part/a.xml'/>"
                                  "<include filename='object.xml'/>"
                                  "<shape type='cube'><ref id='red'/></shape>"
                                  "<shape type='cube'><ref id='object'/></shape>");
    CHECK(s && s->shape_count == 2);
    if (s) {
        check_colour(PARAM(struct texture_ref, s->shapes[0].bsdf, "reflectance").value, .5, 0, 0,
                     1e-7);
        CHECK(strcmp(s->shapes[1].bsdf->id, "object") == 0);
    }
    const uint64_t hash = s ? s->hash : 0;
    scene_destroy(s);
    scene_write("part/b.xml", "<scene version='3.0.0'><default name='r' value='.6'/></scene>");
    s = scene_parse("<path value='lib'/><include filename='part/a.xml'/>"
                    "<include filename='object.xml'/>"
                    "<shape type='cube'><ref id='red'/></shape>"
                    "<shape type='cube'><ref id='object'/></shape>");
    CHECK(s && s->hash != hash); // every file read is part of it
    scene_destroy(s);
    scene_write("part/b.xml", "<scene version='3.0.0'>\n<include filename='a.xml'/></scene>");
    CHECK(!scene_parse("<include filename='part/a.xml'/>"));
    CHECK(captured_has("b.xml:2: includes \"") && captured_has("a cycle"));
    CHECK(!scene_parse("<include filename='none.xml'/>"));
    CHECK(captured_has("scene.xml:2: there is no file \"none.xml\""));
}

// Two files that each include the next one twice: 2^n files.
static void include_bomb(void) {
    char text[256], name[32];
    for (int i = 0; i < 15; i++) {
        snprintf(name, sizeof name, "bomb%d.xml", i);
        snprintf(text, sizeof text, "<scene version='3.0.0'><include filename='bomb%d.xml'/>"
                 "<include filename='bomb%d.xml'/></scene>", i + 1, i + 1);
        scene_write(name, text);
    }
    scene_write("bomb15.xml", "<scene version='3.0.0'/>");
    CHECK(!scene_parse("<include filename='bomb0.xml'/>"));
    CHECK(captured_has("includes"));
}

static void aliases(void) {
    struct scene *s = scene_parse("<bsdf type='diffuse' id='a'/><alias id='a' as='b'/>"
                                  "<alias id='b' as='c'/>"
                                  "<shape type='cube'><ref id='a'/></shape>"
                                  "<shape type='cube'><ref id='c'/></shape>");
    CHECK(s && s->shapes[0].bsdf == s->shapes[1].bsdf && s->bsdf_count == 1);
    scene_destroy(s);
    CHECK(!scene_parse("<alias id='a' as='b'/>"));
    CHECK(captured_has("scene.xml:2: nothing before this has the id \"a\""));
}

static void old_names(void) {
    const struct scene_options options = scene_real_options();
    struct scene *s = scene_parse_with(&options,
        "<scene version='0.5.0'><mode type='final'/>"
        "<integrator type='path'><integer name='maxDepth' value='9'/>"
        "<boolean name='strictNormals' value='true'/></integrator>"
        "<camera type='perspective'><transform name='toWorld'>"
        "<lookAt origin='0 0 5' target='0 0 0' up='0 1 0'/></transform>"
        "<sampler type='ldsampler'><integer name='sampleCount' value='16'/></sampler>"
        "<film type='ldrfilm'><string name='pixelFormat' value='rgba'/>"
        "<integer name='cropWidth' value='10'/><float name='gamma' value='2.2'/></film></camera>"
        "<bsdf type='roughplastic' id='p'><float name='intIOR' value='1.5'/>"
        "<rgb name='diffuseReflectance' value='.1'/></bsdf>"
        "<texture type='checkerboard' id='t'><float name='uoffset' value='.5'/>"
        "<float name='vscale' value='4'/></texture>"
        "<shape type='sphere'><luminaire type='area'/><ref id='p'/></shape></scene>");
    CHECK(s);
    if (!s) {
        printf("%s", captured);
        return;
    }
    CHECK(PARAM(int, s->integrator, "max_depth") == 9);
    CHECK(s->sample_count == 16 && s->film.alpha && s->film.crop_x1 == 10);
    CHECK_NEAR(PARAM(float, s->bsdfs[0], "int_ior"), 1.5, 1e-6);
    CHECK(s->light_count == 1);
    const struct transform uv = PARAM(struct transform, s->textures[0], "to_uv");
    CHECK(uv.m[0][0] == 1 && uv.m[0][3] == .5 && uv.m[1][1] == 4 && uv.m[1][3] == 0);
    CHECK(captured_has("accepted without effect: <mode> (line 1)") && captured_has("gamma"));
    scene_destroy(s);
    // only old files have the old names
    CHECK(!scene_parse("<integrator type='path'><integer name='maxDepth' value='9'/></integrator>"));
    CHECK(captured_has("scene.xml:2: integrator \"path\" has no parameter \"maxDepth\"; did you "
                       "mean \"max_depth\"?"));
}

#define OLD_HEAD "<scene version='0.6.0'><sensor type='perspective'/>\n"

static struct scene *parse_old(const char *body) {
    const struct scene_options options = scene_real_options();
    char text[2048];
    snprintf(text, sizeof text, OLD_HEAD "%s" SCENE_TAIL, body);
    return scene_parse_with(&options, text);
}

// Metals are copper in air, where version 3 has a mirror in vacuum.
static void old_metals(void) {
    static const char *const types[] = {"conductor", "roughconductor"};
    spectrum eta, k;
    float air;
    CHECK(ior_conductor_find("Cu", &eta, &k) && ior_dielectric_find("air", &air));
    for (int i = 0; i < 2; i++) {
        char text[512];
        snprintf(text, sizeof text, "<bsdf type='%s'/><bsdf type='%s'><rgb name='k' value='3'/></bsdf>"
                 "<bsdf type='%s'><string name='material' value='Au'/><float name='extEta' value='1'/>"
                 "</bsdf>", types[i], types[i], types[i]);
        struct scene *s = parse_old(text);
        CHECK(s && s->bsdf_count == 3);
        if (s) {
            const spectrum found = PARAM(spectrum, s->bsdfs[0], "eta");
            check_colour(found, eta[0], eta[1], eta[2], 0);
            check_colour(PARAM(spectrum, s->bsdfs[0], "k"), k[0], k[1], k[2], 0);
            CHECK(PARAM(float, s->bsdfs[0], "ext_eta") == air);
            check_colour(PARAM(spectrum, s->bsdfs[1], "eta"), eta[0], eta[1], eta[2], 0);
            check_colour(PARAM(spectrum, s->bsdfs[1], "k"), 3, 3, 3, 0);
            CHECK(strcmp(PARAM(const char *, s->bsdfs[2], "material"), "Au") == 0);
            check_colour(PARAM(spectrum, s->bsdfs[2], "eta"), 0, 0, 0, 0); // left to the material
            CHECK(PARAM(float, s->bsdfs[2], "ext_eta") == 1);
        }
        scene_destroy(s);
        snprintf(text, sizeof text, "<bsdf type='%s'/>", types[i]);
        s = scene_parse(text);
        CHECK(s);
        if (s)
            check_colour(PARAM(spectrum, s->bsdfs[0], "eta"), 0, 0, 0, 0);
        scene_destroy(s);
    }
    scene_write("metal.xml", "<bsdf version='0.5.0' type='conductor' id='metal'/>");
    struct scene *s = scene_parse("<include filename='metal.xml'/>");
    CHECK(s && PARAM(float, s->bsdfs[0], "ext_eta") == air); // a file that is one object
    scene_destroy(s);
}

static void check_medium(const char *given, const char *names, double a, double b) {
    char text[512], name[2][16];
    snprintf(text, sizeof text, "<medium type='homogeneous'>%s</medium>", given);
    struct scene *s = parse_old(text);
    CHECK(s && s->medium_count == 1 && sscanf(names, "%15s %15s", name[0], name[1]) == 2);
    for (int i = 0; s && i < 2; i++) {
        const struct volume_ref v = PARAM(struct volume_ref, s->media[0], name[i]);
        CHECK(v.given);
        CHECK_NEAR(v.value[0], i ? b : a, 1e-5 * (i ? b : a));
    }
    scene_destroy(s);
}

// A medium of which nothing is said is skin; what is missing of a pair is skin's.
static void old_media(void) {
    check_medium("", "sigma_s sigma_a", 74, 3.2);
    check_medium("<rgb name='sigmaA' value='1'/>", "sigma_s sigma_a", 74, 1);
    check_medium("<rgb name='sigmaT' value='2'/>", "sigma_t albedo", 2, 74 / 77.2);
    check_medium("<rgb name='albedo' value='.5'/>", "sigma_t albedo", 77.2, .5);
    struct scene *s = parse_old("<medium type='homogeneous'><string name='material' value='Apple'/>"
                                "</medium>");
    CHECK(s && !PARAM(struct volume_ref, s->media[0], "sigma_s").given);
    scene_destroy(s);
}

static void check_sky(const char *light, double scale, double sky, double sun) {
    struct scene *s = parse_old(light);
    CHECK(s && s->light_count == 1);
    if (s) {
        const struct object *o = s->lights[0].object;
        check_colour(PARAM(spectrum, o, "albedo"), .2, .2, .2, 1e-7);
        CHECK(PARAM(float, o, "scale") == (float)scale && PARAM(float, o, "sky_scale") == (float)sky &&
              PARAM(float, o, "sun_scale") == (float)sun && PARAM(int, o, "up") == 1);
    }
    scene_destroy(s);
}

// Scales of sun and sky stand in place of the common one.
static void old_skies(void) {
#define SCALE(name, value) "<float name='" name "' value='" value "'/>"
    check_sky("<emitter type='sky'/>", 1, 1, 0);
    check_sky("<emitter type='sun'>" SCALE("scale", "3") "</emitter>", 1, 0, 3);
    check_sky("<emitter type='sunsky'>" SCALE("scale", "3") "</emitter>", 3, 1, 1);
    check_sky("<emitter type='sunsky'>" SCALE("scale", "3") SCALE("sunScale", "5") "</emitter>", 1, 3, 5);
    check_sky("<emitter type='sunsky'>" SCALE("skyScale", "2") SCALE("sunScale", "5") "</emitter>", 1, 2, 5);
    check_sky("<emitter type='sunsky'>" SCALE("scale", "3") SCALE("skyScale", "2") SCALE("sunScale", "5")
              "</emitter>", 1, 2, 5);
    CHECK(captured_has("accepted without effect: scale (line 2)"));
#undef SCALE
}

// One number as a light's spectrum: grey, where version 3 has equal energy at all wavelengths.
static void old_spectrum(void) {
    const char *body = "<emitter type='constant'><spectrum name='radiance' value='2'/></emitter>"
                       "<emitter type='point'><spectrum name='intensity' value='400:1 700:1'/></emitter>";
    struct scene *old = parse_old(body), *s = scene_parse(body);
    CHECK(old && s);
    if (old && s) {
        check_colour(PARAM(spectrum, old->lights[0].object, "radiance"), 2, 2, 2, 0);
        check_colour(PARAM(spectrum, s->lights[0].object, "radiance"), 2.409, 1.896, 1.818, 2e-3);
        const spectrum samples = PARAM(spectrum, s->lights[1].object, "intensity");
        check_colour(PARAM(spectrum, old->lights[1].object, "intensity"), samples[0], samples[1], samples[2], 0);
    }
    scene_destroy(old);
    scene_destroy(s);
}

static void old_letters(void) {
    const struct scene_options options = scene_real_options();
    struct scene *s = scene_parse_with(&options,
        "<scene version='0.5.0'><sensor type='perspective'><film type='hdrfilm'>"
        "<rfilter type='mitchell'><float name='B' value='.5'/></rfilter></film></sensor></scene>");
    CHECK(s && PARAM(float, s->filter, "B") == .5f);
    scene_destroy(s);
    CHECK(!scene_parse_with(&options, "<scene version='0.3.0'><sensor type='perspective'/></scene>"));
    CHECK(captured_has("scene.xml:1: <scene> has version \"0.3.0\", expected 0.4 to 3.x"));
}

int main(void) {
    scene_folder_open();
    variables();
    unused_variable();
    includes();
    include_bomb();
    aliases();
    old_names();
    old_metals();
    old_media();
    old_skies();
    old_spectrum();
    old_letters();
    scene_folder_close();
    return check_result();
}
