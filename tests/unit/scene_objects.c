// SPDX-License-Identifier: Apache-2.0
// Objects by parameter table: every type of parameter with registries of this test's own, so that
// the reader is shown to know no entry by name, and every message about them.
#include "scene_text.h"

struct thing {
    bool flag;
    int count, choice;
    float number, ior;
    const char *text;
    vec3 point, vector;
    struct transform transform;
    spectrum reflectance, emission, index;
    struct texture_ref colour, light, scalar;
    const struct object *first, *second;
};

#define AT(name) offsetof(struct thing, name)

static const char *const choices[] = {"left", "right", NULL};
static const struct param thing_params[] = {
    {"flag", PARAM_BOOL, AT(flag), .def = "true"},
    {"count", PARAM_INT, AT(count), .def = "3", .min = 1, .max = 10},
    {"choice", PARAM_CHOICE, AT(choice), .def = "right", .choices = choices},
    {"number", PARAM_FLOAT, AT(number), .def = "0.5", .min = -1, .max = 1, .unit = "m",
     .aka = "old_number"},
    {"ior", PARAM_IOR, AT(ior), .def = "water"},
    {"text", PARAM_STRING, AT(text), .optional = true},
    {"point", PARAM_POINT, AT(point), .def = "1 2 3"},
    {"vector", PARAM_VECTOR, AT(vector), .def = "4"},
    {"transform", PARAM_TRANSFORM, AT(transform), .def = ""},
    {"reflectance", PARAM_REFLECTANCE, AT(reflectance), .def = "0.1 0.2 0.3", .max = 1},
    {"emission", PARAM_EMISSION, AT(emission), .def = "d65"},
    {"index", PARAM_INDEX, AT(index), .def = "2"},
    {"colour", PARAM_TEXTURE, AT(colour), .def = "0.5", .max = 1},
    {"light", PARAM_TEXTURE_EMISSION, AT(light), .def = "1"},
    {"scalar", PARAM_TEXTURE_SCALAR, AT(scalar), .def = "0.25"},
    {"first", PARAM_BSDF, AT(first), .optional = true},
    {"second", PARAM_BSDF, AT(second), .optional = true},
    {"old", PARAM_IGNORED},
    PARAM_END,
};

struct needy {
    float must;
};

static const struct param needy_params[] = {
    {"must", PARAM_FLOAT, offsetof(struct needy, must), .help = "what it needs"}, PARAM_END};

static const char *const thing_aliases[] = {"item", NULL};
static const struct entry thing = {"thing", "", thing_aliases, thing_params, sizeof(struct thing)};
static const struct entry needy = {"needy", "", NULL, needy_params, sizeof(struct needy)};
static const struct entry diffuse = {"diffuse", "", NULL, thing_params, sizeof(struct thing)};
static const struct entry *const fake_entries[] = {&thing, &needy, &diffuse, NULL};
static const struct registry fake_bsdfs = {"bsdf", fake_entries};
static const struct entry pattern = {"pattern", "", NULL, NULL, 0};
static const struct entry *const pattern_entries[] = {&pattern, NULL};
static const struct registry fake_textures = {"texture", pattern_entries};

static struct scene *parse_fake(const char *body, bool lenient) {
    struct scene_options options = scene_real_options();
    options.registries.bsdfs = &fake_bsdfs;
    options.registries.textures = &fake_textures;
    options.lenient = lenient;
    char text[4096];
    snprintf(text, sizeof text, SCENE_HEAD "%s" SCENE_TAIL, body);
    return scene_parse_with(&options, text);
}

static void defaults(void) {
    struct scene *s = parse_fake("<bsdf type='item' id='x'/>", false);
    CHECK(s && s->bsdf_count == 1);
    if (!s)
        return;
    const struct thing *t = s->bsdfs[0]->data;
    CHECK(s->bsdfs[0]->type == &thing && strcmp(s->bsdfs[0]->id, "x") == 0);
    CHECK(s->bsdfs[0]->at.line == 2);
    CHECK(t->flag && t->count == 3 && t->choice == 1 && t->number == 0.5f && !t->text);
    CHECK(t->ior == 1.333f && t->point[2] == 3 && t->vector[0] == 4 && t->vector[2] == 4);
    CHECK(transform_is_identity(&t->transform));
    check_colour(t->reflectance, 0.1, 0.2, 0.3, 1e-7);
    check_colour(t->emission, 1, 1, 1, 0);
    check_colour(t->index, 2, 2, 2, 0);
    check_colour(t->colour.value, 0.5, 0.5, 0.5, 0);
    check_colour(t->scalar.value, 0.25, 0.25, 0.25, 0);
    CHECK(!t->colour.texture && !t->first && !t->second);
    scene_destroy(s);
}

static void values(void) {
    struct scene *s = parse_fake(
        "<texture type='pattern' id='p'/>"
        "<bsdf type='thing' id='a'><boolean name='flag' value='false'/>"
        "<integer name='count' value='10'/><string name='choice' value='left'/>"
        "<float name='old_number' value='-1e0'/><float name='ior' value='1.7'/>"
        "<string name='text' value='hello'/><vector name='point' x='1' z='2'/>"
        "<ref name='colour' id='p'/><texture name='light' type='pattern'/>"
        "<ref id='p' name='scalar'/><ref id='b'/>"
        "<bsdf type='thing' name='anything'/></bsdf>"
        "<bsdf type='thing' id='b'/>", false);
    CHECK(s && s->bsdf_count == 3 && s->texture_count == 2);
    if (!s) {
        printf("%s", captured);
        return;
    }
    // children first: the forward reference, the nested one, then the owner
    CHECK(strcmp(s->bsdfs[0]->id, "b") == 0 && strcmp(s->bsdfs[2]->id, "a") == 0);
    const struct thing *t = s->bsdfs[2]->data;
    CHECK(!t->flag && t->count == 10 && t->choice == 0 && t->number == -1 && t->ior == 1.7f);
    CHECK(strcmp(t->text, "hello") == 0 && t->point[0] == 1 && t->point[1] == 0);
    CHECK(t->colour.texture == s->textures[0] && t->scalar.texture == s->textures[0]);
    CHECK(t->light.texture == s->textures[1]);
    CHECK(t->first == s->bsdfs[0] && t->second == s->bsdfs[1]);
    CHECK(captured_has("accepted without effect: name=\"anything\" (line 2)"));
    scene_destroy(s);
}

// Names of places that do not exist, and references where nothing is placed.
static void places(void) {
    struct scene *s = scene_parse("<bsdf type='diffuse' id='b'/><texture type='checkerboard' id='t'/>\n"
                                  "<shape type='sphere'><ref id='b' name='bogus'/></shape>\n"
                                  "<shape type='sphere'><bsdf type='diffuse' name='fake'/></shape>\n"
                                  "<shape type='sphere'><ref id='b' name='bsdf'/></shape>\n"
                                  "<ref id='b'/><ref id='t'/>");
    CHECK(s && s->bsdf_count == 2 && s->texture_count == 1);
    CHECK(captured_has("accepted without effect: name=\"bogus\" (line 3), name=\"fake\" (line 4)\n"));
    scene_destroy(s);
    static const char *const objects[][2] = {
        {"sensor", "<sensor type='perspective' id='x'/>"},
        {"film", "<sensor type='perspective'><film type='hdrfilm' id='x'/></sensor>"},
        {"shape", "<shape type='sphere' id='x'/>"},
        {"emitter", "<emitter type='constant' id='x'/>"},
        {"integrator", "<integrator type='path' id='x'/>"},
    };
    for (size_t i = 0; i < sizeof objects / sizeof *objects; i++) {
        char text[256], said[128];
        snprintf(text, sizeof text, "%s\n<ref id='x'/>", objects[i][1]);
        snprintf(said, sizeof said, "scene.xml:3: a reference to the <%s> \"x\" cannot stand directly in a "
                 "scene", objects[i][0]);
        CHECK(!scene_parse(text));
        CHECK(captured_has(said));
    }
}

// The message of a faulty material in line 2.
static void check_fault(const char *inside, const char *message) {
    char body[2048];
    snprintf(body, sizeof body, "<texture type='pattern' id='p'/><bsdf type='thing' id='a'>\n%s"
             "</bsdf>", inside);
    struct scene *s = parse_fake(body, false);
    CHECK(!s);
    CHECK(captured_has("scene.xml:3: ") && captured_has(message));
    if (!captured_has(message) || !captured_has("scene.xml:3: "))
        printf("%s\nsays: %sexpected: %s\n", inside, captured, message);
    scene_destroy(s);
}

static void faults(void) {
    check_fault("<float name='numbr' value='1'/>",
                "bsdf \"thing\" has no parameter \"numbr\"; did you mean \"number\"?");
    check_fault("<float name='quite_other' value='1'/>", "it has: flag count choice number");
    check_fault("<float name='number' value='2'/>", "\"number\" is 2 m, expected -1 to 1");
    check_fault("<float name='number' value='nan'/>", "expected a finite number");
    check_fault("<float name='number' value='1 2'/>", "expected a finite number");
    check_fault("<float name='number' value=''/>", "expected a finite number");
    check_fault("<float name='ior' value='1e39'/>", "exceeds the range of numbers");
    check_fault("<string name='ior' value='watr'/>", "a material such as \"water\"");
    check_fault("<integer name='count' value='11'/>", "\"count\" is 11, expected 1 to 10");
    check_fault("<integer name='count' value='2.5'/>", "expected a whole number");
    check_fault("<float name='count' value='2'/>",
                "\"count\" is given as <float>, expected <integer>");
    check_fault("<boolean name='flag' value='yes'/>", "expected true or false");
    check_fault("<string name='choice' value='up'/>",
                "\"choice\" is \"up\", expected one of left, right");
    check_fault("<rgb name='reflectance' value='.5 2 .5'/>",
                "\"reflectance\" is 2, expected 0 to 1");
    check_fault("<rgb name='reflectance' value='1 2'/>", "expected one or three numbers");
    check_fault("<rgb name='reflectance' value='#12345'/>", "expected #rrggbb");
    check_fault("<rgb name='emission' value='-1 0 0'/>", "expected no negative values");
    check_fault("<spectrum name='emission' value='400:1 300:2'/>", "expected ascending ones");
    check_fault("<spectrum name='emission' value='400:1'/>", "a spectrum of 1 samples");
    check_fault("<spectrum name='emission' value='400:x'/>", "pairs wavelength:value");
    check_fault("<spectrum name='emission'/>", "needs either value or filename");
    check_fault("<spectrum name='emission' filename='none.spd'/>", "no file \"none.spd\"");
    check_fault("<spectrum name='emission' type='blackbdy'/>",
                "spectrum \"blackbdy\" is not known; did you mean \"blackbody\"?");
    check_fault("<spectrum name='emission' type='blackbody'><float name='temperature' value='1'/>"
                "</spectrum>", "expected 100 to 1000000");
    check_fault("<ref name='emission' id='p'/>", "takes no texture");
    check_fault("<ref name='number' id='p'/>", "\"number\" cannot be a texture");
    check_fault("<ref name='colour' id='q'/>", "nothing has the id \"q\"");
    check_fault("<point name='point' x='1' value='1 2 3'/>", "both value and x, y, z");
    check_fault("<point name='point' value='1 2'/>", "expected one or three numbers");
    check_fault("<float name='number' value='0'/><float name='number' value='0'/>", "given twice");
    check_fault("<float value='0'/>", "<float> lacks the attribute \"name\"");
    check_fault("<float name='number' value='0' unit='m'/>", "<float> has no attribute \"unit\"");
    check_fault("<floot name='number' value='0'/>", "did you mean <float>?");
    check_fault("<bsdf type='thong'/>", "bsdf \"thong\" is not known; did you mean \"thing\"?");
    check_fault("<bsdf type='needy'/>", "bsdf \"needy\" lacks the parameter \"must\" (what it needs)");
    check_fault("<bsdf type='thing'/><bsdf type='thing'/><bsdf type='thing'/>",
                "bsdf \"thing\" has no place for a bsdf");
    check_fault("<integrator type='path'/>", "has no place for a integrator");
    check_fault("<transform name='transform'><scale value='0'/></transform>", "has no inverse");
    check_fault("<transform name='transform'><rotate angle='3'/></transform>", "has no axis");
    check_fault("<transform name='transform'><matrix value='1 2 3'/></transform>",
                "expected 16 or 9 finite numbers");
    check_fault("<transform name='transform'><matrix value='1 0 0 0  0 1 0 0  0 0 1 0  0 0 1 0'/>"
                "</transform>", "0 0 1 0 as its last row");
    check_fault("<transform name='transform'><lookat origin='0 0 0' target='0 0 0'/></transform>",
                "origin and target coincide");
    check_fault("<transform name='transform'><float name='x' value='1'/></transform>",
                "<float> inside <transform>");
}

static void cycle(void) {
    CHECK(!parse_fake("<bsdf type='thing' id='a'><ref id='a'/></bsdf>", false));
    CHECK(captured_has("scene.xml:2: \"a\" contains itself"));
    CHECK(!parse_fake("<bsdf type='thing' id='a'><ref id='b'/></bsdf>"
                      "<bsdf type='thing' id='b'><ref id='c'/></bsdf>"
                      "<bsdf type='thing' id='c'><ref id='a'/></bsdf>", false));
    CHECK(captured_has("\"a\" contains itself"));
    CHECK(!parse_fake("<spectrum type='d65' id='x'><ref name='color' id='y'/></spectrum>"
                      "<spectrum type='d65' id='y'><ref name='color' id='x'/></spectrum>"
                      "<bsdf type='thing'><ref name='emission' id='x'/></bsdf>", false));
    CHECK(captured_has("contains itself"));
    CHECK(!parse_fake("<bsdf type='thing' id='a'/>\n<bsdf type='thing' id='a'/>", false));
    CHECK(captured_has("scene.xml:3: id \"a\" is taken") && captured_has("scene.xml:2"));
}

// A chain of references deeper than the stack should have to bear.
static void chain(void) {
    char body[8192];
    size_t used = 0;
    for (int i = 0; i < 80; i++)
        used += (size_t)snprintf(body + used, sizeof body - used,
                                 "<bsdf type='thing' id='n%d'><ref id='n%d'/></bsdf>", i, i + 1);
    snprintf(body + used, sizeof body - used, "<bsdf type='thing' id='n80'/>");
    char text[9000];
    snprintf(text, sizeof text, SCENE_HEAD "%s" SCENE_TAIL, body);
    struct scene_options options = scene_real_options();
    options.registries.bsdfs = &fake_bsdfs;
    CHECK(!scene_parse_with(&options, text));
    CHECK(captured_has("nested more than 64 deep"));
}

static void lenient(void) {
    struct scene *s = parse_fake("<bsdf type='thing'><float name='numbr' value='1'/>"
                                 "<float name='old' value='1'/></bsdf>"
                                 "<bsdf type='thing'><float name='old' value='1'/></bsdf>", true);
    CHECK(s && captured_has("warning: ") && captured_has("did you mean \"number\"?"));
    const char *report = strstr(captured, "accepted without effect: old (line 2)");
    CHECK(report && !strstr(report + 30, "old"));
    scene_destroy(s);
}

int main(void) {
    scene_folder_open();
    defaults();
    values();
    faults();
    cycle();
    chain();
    lenient();
    places();
    scene_folder_close();
    return check_result();
}
