// SPDX-License-Identifier: Apache-2.0
// Media, phase functions and volumes in scene files: where they may stand, what they mean, and what
// is said about mistakes.
#include "driver/method.h"
#include "medium/named.h"
#include "medium_text.h"
#include "scene_text.h"
#include "world/world.h"

#define FOG "<medium type='homogeneous' id='fog'><float name='sigma_t' value='2'/></medium>"

// The world of a scene, or NULL with what was said in `captured`.
static struct world *build(struct scene *s) {
    capture_begin();
    struct world *w = s ? world_create(s, 1) : NULL;
    capture_end();
    return w;
}

static void test_places(void) {
    struct scene *s = scene_parse(
        FOG "<medium type='homogeneous' id='air'/>"
        "<shape type='sphere'><ref id='fog' name='interior'/><ref name='exterior' id='air'/>"
        "<bsdf type='null'/></shape><shape type='cube'/>");
    CHECK(s && s->medium_count == 2 && s->shape_count == 2);
    if (!s)
        return;
    CHECK(s->shapes[0].interior == 0 && s->shapes[0].exterior == 1);
    CHECK(s->shapes[1].interior == SCENE_NONE && s->shapes[1].exterior == SCENE_NONE);
    CHECK(s->sensor_medium == SCENE_NONE);
    struct world *w = build(s);
    CHECK(w && w->boundaries[0].parts && !w->boundaries[1].parts);
    CHECK(w && w->media[0].homogeneous && w->media[0].grey && w->media[0].scatters);
    if (w) {
        CHECK_NEAR(w->media[0].constant.sigma_t[1], 2, 0);
        CHECK_NEAR(w->media[0].constant.sigma_s[1], 1.5, 0);
    }
    world_destroy(w);
    scene_destroy(s);
}

static void test_sensor(void) {
    const struct scene_options options = scene_real_options();
    struct scene *s = scene_parse_with(
        &options, "<scene version='3.0.0'><sensor type='perspective'>"
                  "<medium name='medium' type='homogeneous'/></sensor></scene>");
    CHECK(s && s->medium_count == 1 && s->sensor_medium == 0);
    scene_destroy(s);
}

static const char *bsdf_of(struct scene *s) {
    return s ? s->shapes[0].bsdf->type->name : "";
}

// Old files mean no surface around a medium; new ones mean a diffuse one, and are warned.
static void test_default_material(void) {
    const struct scene_options options = scene_real_options();
    struct scene *s = scene_parse("<shape type='sphere'><medium name='interior' "
                                  "type='homogeneous'/></shape>");
    CHECK(strcmp(bsdf_of(s), "diffuse") == 0 && strstr(captured, "null"));
    scene_destroy(s);
    s = scene_parse_with(&options, "<scene version='0.5.0'><sensor type='perspective'/>"
                                   "<shape type='sphere'><medium name='interior' type="
                                   "'homogeneous'><rgb name='sigmaA' value='1 2 3'/>"
                                   "<rgb name='sigmaS' value='1 1 1'/></medium></shape></scene>");
    CHECK(strcmp(bsdf_of(s), "null") == 0);
    struct world *w = build(s);
    CHECK(w && !w->media[0].grey && w->media[0].constant.sigma_t[2] == 4);
    world_destroy(w);
    scene_destroy(s);
}

static void test_refusals(void) {
    static const struct {
        const char *scene, *words;
    } cases[] = {
        {"<shape type='sphere'>" FOG "</shape>", "\"interior\" or \"exterior\""},
        {FOG "<shape type='sphere'><ref name='interior' id='fog'/><ref name='interior' id='fog'/>"
         "</shape>", "second interior"},
        {"<medium type='homogenous'/>", "did you mean \"homogeneous\""},
        {"<medium type='homogeneous'><float name='sigma' value='1'/></medium>", "no parameter"},
        {"<medium type='homogeneous'><float name='sigma_t' value='-1'/></medium>", "expected 0 to"},
        {"<medium type='homogeneous'><float name='albedo' value='1.5'/></medium>", "expected 0 to 1"},
        {"<medium type='homogeneous'><phase type='hg'><float name='g' value='1'/></phase></medium>",
         "0.999999"},
        {"<medium type='heterogeneous'><volume type='gridvolume' name='sigma_t'>"
         "<string name='filename' value='none.vol'/></volume></medium>", "there is no file"},
        {"<medium type='homogeneous'><phase type='blendphase'/></medium>", "phase1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene *s = scene_parse(cases[i].scene);
        CHECK(!s);
        CHECK(strstr(captured, cases[i].words));
        if (!strstr(captured, cases[i].words))
            printf("%s\n%s", cases[i].scene, captured);
        scene_destroy(s);
    }
}

static void test_world_refusals(void) {
    static const struct {
        const char *scene, *words;
    } cases[] = {
        {"<medium type='homogeneous'><float name='sigma_t' value='1'/>"
         "<float name='sigma_s' value='1'/></medium>", "expected one of"},
        {"<medium type='homogeneous'><phase type='tabphase'><string name='values' value='1,2,x'/>"
         "</phase></medium>", "value 3 is \"x\""},
        {"<medium type='homogeneous'><phase type='tabphase'><string name='values' value='1,-1'/>"
         "</phase></medium>", "value 2 is \"-1\""},
        {"<medium type='homogeneous'><phase type='tabphase'><string name='values' value='1 2e40'/>"
         "</phase></medium>", "value 2 is \"2e40\""},
        {"<medium type='homogeneous'><phase type='tabphase'><string name='values' value='3'/>"
         "</phase></medium>", "1 values; expected at least two"},
        {"<medium type='homogeneous'><phase type='tabphase'><string name='values' value='0,0'/>"
         "</phase></medium>", "not all 0"},
        {"<medium type='homogeneous'><phase type='tabphase'><string name='values' value=' , '/>"
         "</phase></medium>", "0 values"},
        {"<medium type='homogeneous'><string name='material' value='Ketchop'/></medium>",
         "did you mean \"Ketchup\""},
        {"<medium type='heterogeneous'><volume type='gridvolume' name='sigma_t'>"
         "<string name='filename' value='bad.vol'/></volume></medium>", "version 2"},
        {"<medium type='heterogeneous'><volume type='gridvolume' name='sigma_t'>"
         "<string name='filename' value='short.vol'/></volume></medium>", "ends after"},
    };
    scene_write("bad.vol", "VOL\2 and so on, until there is room for a header of 48 bytes ........");
    const int size[3] = {2, 2, 2};
    const float values[8] = {0};
    test_write_vol(scene_path("long.vol"), size, 1, values, NULL);
    size_t n;
    char *bytes = file_read(scene_path("long.vol"), 0, &n);
    CHECK(file_write(scene_path("short.vol"), bytes, n - 1));
    mem_free(bytes);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene *s = scene_parse(cases[i].scene);
        CHECK(s);
        struct world *w = build(s);
        CHECK(!w && strstr(captured, cases[i].words));
        scene_destroy(s);
    }
}

static void test_named(void) {
    struct medium_point c;
    float g;
    CHECK(named_medium_find("skin1", (struct where){0}, &c, &g));
    CHECK_NEAR(c.sigma_s[0], 0.74, 1e-6);
    CHECK_NEAR(c.sigma_t[2], 1.01 + 0.48, 1e-6);
    CHECK(g == 0);
    for (size_t i = 0; named_medium_name(i); i++) {
        CHECK(named_medium_find(named_medium_name(i), (struct where){0}, &c, &g));
        CHECK(g >= 0 && g < 1 && spectrum_min(c.sigma_t - c.sigma_s) >= 0);
    }
}

// Which integrator runs.
static void test_method(void) {
    static const struct {
        const char *scene, *used;
    } cases[] = {
        {"<integrator type='volpath'/>", "path"},
        {"<integrator type='volpathmis'/>", "path"},
        {"<integrator type='volpath'><integer name='max_depth' value='4'/></integrator>", "path"},
        {"<integrator type='volpath'><integer name='max_depth' value='4'/></integrator>"
         "<shape type='cube'><bsdf type='mask'><float name='opacity' value='0.5'/>"
         "<bsdf type='diffuse'/></bsdf></shape>", "volpath"},
        {"<integrator type='moment'><integrator type='volpath'/></integrator>", "path"},
        {FOG "<integrator type='volpathmis'/><shape type='cube'><bsdf type='null'/>"
         "<ref name='interior' id='fog'/></shape>", "volpath"},
        {"<medium type='homogeneous' id='m'><rgb name='sigma_t' value='1 2 3'/></medium>"
         "<integrator type='volpathmis'/><shape type='cube'><bsdf type='null'/>"
         "<ref name='interior' id='m'/></shape>", "volpathmis"},
        {FOG "<integrator type='path'/><shape type='cube'><bsdf type='null'/>"
         "<ref name='interior' id='fog'/></shape>", "path"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct method m;
        struct scene *s = scene_parse(cases[i].scene);
        struct world *w = build(s);
        CHECK(w);
        if (!w)
            continue;
        capture_begin();
        method_choose(s, w, &m);
        capture_end();
        CHECK(strcmp(m.used, cases[i].used) == 0);
        if (strcmp(m.used, cases[i].used) != 0)
            printf("%s: %s\n", cases[i].scene, m.used);
        CHECK((strstr(captured, "does not see") != NULL) == (i == 7));
        world_destroy(w);
        scene_destroy(s);
    }
}

int main(void) {
    scene_folder_open();
    test_places();
    test_sensor();
    test_default_material();
    test_refusals();
    test_world_refusals();
    test_named();
    test_method();
    scene_folder_close();
    return check_result();
}
