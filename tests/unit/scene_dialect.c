// SPDX-License-Identifier: Apache-2.0
// Several files, variables, aliases, and the names of versions before 2.
#include <sys/stat.h>

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

int main(void) {
    scene_folder_open();
    variables();
    unused_variable();
    includes();
    include_bomb();
    aliases();
    old_names();
    scene_folder_close();
    return check_result();
}
