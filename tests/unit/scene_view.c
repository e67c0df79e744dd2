// SPDX-License-Identifier: Apache-2.0
// Film, sampler, sensors, integrators and what the user asks for instead; files that are no scenes.
#include "scene_text.h"

static struct scene *parse(const char *text, const char *integrator, const char *sampler) {
    struct scene_options options = scene_real_options();
    options.integrator = integrator;
    options.sampler = sampler;
    return scene_parse_with(&options, text);
}

#define SENSOR "<sensor type='perspective'/>"

static void film(void) {
    struct scene *s = parse(
        "<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'>"
        "<integer name='width' value='100'/><integer name='height' value='50'/>"
        "<integer name='crop_offset_x' value='10'/><integer name='crop_offset_y' value='20'/>"
        "<integer name='crop_width' value='30'/><integer name='crop_height' value='25'/>"
        "<string name='pixel_format' value='luminance'/><rfilter type='tent'/></film></sensor>"
        "<sensor type='orthographic'/></scene>", NULL, NULL);
    CHECK(s && s->sensor_count == 2);
    CHECK(captured_has("the first of 2 sensors is used"));
    if (s) {
        const struct film_settings f = s->film;
        CHECK(f.width == 100 && f.height == 50 && !f.alpha);
        CHECK(f.crop_x0 == 10 && f.crop_y0 == 20 && f.crop_x1 == 40 && f.crop_y1 == 45);
        CHECK(strcmp(s->filter->type->name, "tent") == 0);
        CHECK(strcmp(s->sampler->type->name, "sobol") == 0 && s->sample_count == 0);
        CHECK(strcmp(s->integrator->type->name, "path") == 0);
    }
    scene_destroy(s);
    s = parse("<scene version='3.0.0'>" SENSOR "</scene>", NULL, NULL);
    CHECK(s && s->film.width == 768 && s->film.height == 576 && s->film.crop_x1 == 768);
    CHECK(s && strcmp(s->filter->type->name, "gaussian") == 0);
    scene_destroy(s);
    struct scene_options options = scene_real_options();
    options.width = 20;
    options.height = 10;
    s = scene_parse_with(&options, "<scene version='3.0.0'>" SENSOR "</scene>");
    CHECK(s && s->film.width == 20 && s->film.crop_x1 == 20 && s->film.crop_y1 == 10);
    scene_destroy(s);
}

static void sampler(void) {
    const char *text = "<scene version='3.0.0'><sensor type='perspective'>"
                       "<sampler type='independent'><integer name='sample_count' value='77'/>"
                       "<integer name='seed' value='5'/></sampler></sensor></scene>";
    struct scene *s = parse(text, NULL, NULL);
    CHECK(s && s->sample_count == 77 && strcmp(s->sampler->type->name, "independent") == 0);
    scene_destroy(s);
    s = parse(text, NULL, "sobol");
    CHECK(s && s->sample_count == 77 && strcmp(s->sampler->type->name, "sobol") == 0);
    scene_destroy(s);
    CHECK(!parse(text, NULL, "sobel"));
    CHECK(captured_has("sampler \"sobel\" is not known; did you mean \"sobol\"?"));
}

// Samplers that are not there: which takes their place is said, once.
static void sampler_replaced(void) {
    static const char *const names[] = {"ldsampler", "halton", "hammersley", "orthogonal", "sobol"};
    for (int i = 0; i < 5; i++) {
        char text[512], said[64];
        snprintf(text, sizeof text, "<scene version='3.0.0'>\n<sensor type='perspective'><sampler type='%s'/>"
                 "</sensor><sensor type='thinlens'><float name='aperture_radius' value='1'/>"
                 "<sampler type='%s'/></sensor></scene>", names[i], names[i]);
        snprintf(said, sizeof said, "scene.xml:2: sampler \"%s\" is read as \"sobol\"", names[i]);
        struct scene *s = parse(text, NULL, NULL);
        CHECK(s && strcmp(s->sampler->type->name, "sobol") == 0);
        const char *first = strstr(captured, said);
        CHECK((first != NULL) == (strcmp(names[i], "sobol") != 0));
        CHECK(!first || !strstr(first + 1, said));
        scene_destroy(s);
    }
}

static void check_integrator(const char *xml, const char *wanted, const char *outer,
                             const char *inner, int depth, unsigned warnings) {
    char text[1024];
    snprintf(text, sizeof text, "<scene version='3.0.0'>" SENSOR "%s</scene>", xml);
    const unsigned before = log_warning_count();
    struct scene *s = parse(text, wanted, NULL);
    CHECK(s);
    if (!s) {
        printf("%s\n%s", xml, captured);
        return;
    }
    const struct object *o = s->integrator;
    CHECK(strcmp(o->type->name, outer) == 0);
    if (inner) {
        for (const struct param *p = o->type->params; p->name; p++)
            if (p->type == PARAM_INTEGRATOR) {
                o = *(const struct object *const *)((const char *)o->data + p->offset);
                break;
            }
        CHECK(o && o->type && strcmp(o->type->name, inner) == 0);
    }
    if (depth)
        CHECK(PARAM(int, o, "max_depth") == depth);
    CHECK(log_warning_count() - before == warnings);
    scene_destroy(s);
}

static void integrator_choice(void) {
    const char *path = "<integrator type='path'><integer name='max_depth' value='7'/></integrator>";
    const char *wrapped = "<integrator type='moment'><integrator type='path'>"
                          "<integer name='max_depth' value='7'/></integrator></integrator>";
    check_integrator("", NULL, "path", NULL, 0, 0);
    check_integrator(path, NULL, "path", NULL, 7, 0);
    check_integrator(path, "simple", "simple", NULL, 7, 0);
    check_integrator(path, "direct", "direct", NULL, 0, 0); // what direct does not know is dropped
    check_integrator(path, "path", "path", NULL, 7, 0);
    check_integrator(path, "moment", "moment", "path", 7, 0);
    check_integrator(wrapped, NULL, "moment", "path", 7, 0);
    check_integrator(wrapped, "simple", "moment", "simple", 7, 0);
    check_integrator("", "direct", "direct", NULL, 0, 0);
    // not known: path with its depth, and one warning, however many parameters it has
    check_integrator("<integrator type='sppm'><integer name='max_depth' value='7'/>"
                     "<integer name='photon_count' value='9'/><float name='x' value='1'/>"
                     "</integrator>", NULL, "path", NULL, 7, 1);
    check_integrator("<integrator type='sppm'><integer name='max_depth' value='7'/>"
                     "</integrator>", "simple", "simple", NULL, 7, 0);
    // nor need a name that nobody defined be known where another is asked for
    const char *named = "<integrator type='$method'><integer name='max_depth' value='7'/>"
                        "<integer name='photon_count' value='9'/></integrator>";
    check_integrator(named, "path", "path", NULL, 7, 0);
    check_integrator(named, "moment", "moment", "path", 7, 1);
    CHECK(!parse("<scene version='3.0.0'>" SENSOR "<integrator type='$method'/></scene>", NULL, NULL));
    CHECK(captured_has("$method is not defined by -D or <default>"));
    CHECK(!parse("<scene version='3.0.0'>" SENSOR "</scene>", "pth", NULL));
    CHECK(captured_has("integrator \"pth\" is not known; did you mean \"path\"?"));
}

static void check_fault(const char *text, const char *message) {
    struct scene *s = parse(text, NULL, NULL);
    CHECK(!s);
    CHECK(captured_has("scene.xml") && captured_has(message));
    if (!captured_has(message))
        printf("%s\nsays: %sexpected: %s\n", text, captured, message);
    scene_destroy(s);
}

static void faults(void) {
    check_fault("", "is not well-formed XML");
    check_fault("<scene version='3.0.0'>\n<shape></scene>", "scene.xml:2: is not well-formed XML");
    check_fault("<scene version='3.0.0'/>", "the scene has no sensor");
    check_fault("<scene/>", "has version \"\", expected");
    check_fault("<scene version='4.0.0'/>", "has version \"4.0.0\", expected 0.4 to 3.x");
    check_fault("<scene version='x'/>", "has version \"x\"");
    check_fault("<bsdf version='3.0.0' type='diffuse'/>", "the outermost element is <bsdf>");
    check_fault("<scene version='3.0.0'><sensr type='perspective'/></scene>",
                "<sensr> is not an element of a scene; did you mean <sensor>?");
    check_fault("<!DOCTYPE a [<!ENTITY b 'c'>]><scene version='3.0.0'/>",
                "declares the entity \"b\"");
    check_fault("<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'>"
                "<integer name='crop_width' value='999'/></film></sensor></scene>",
                "does not lie in the picture");
    check_fault("<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'>"
                "<integer name='width' value='0'/></film></sensor></scene>",
                "\"width\" is 0 pixels, expected 1 to 65536");
    check_fault("<scene version='3.0.0'><sensor type='perspective'><film type='hdrfil'/></sensor>"
                "</scene>", "film \"hdrfil\" is not known; did you mean \"hdrfilm\"?");
    check_fault("<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'/>"
                "<film type='hdrfilm'/></sensor></scene>", "a second film in one sensor");
    check_fault("<scene version='3.0.0'><sensor type='perspective'><sampler type='independent'>"
                "<integer name='sample_count' value='0'/></sampler></sensor></scene>",
                "sample_count is \"0\"");
    check_fault("<scene version='3.0.0'>" SENSOR "<integrator type='path'/>"
                "<integrator type='path'/></scene>", "a second integrator");
    char deep[4096] = "<scene version='3.0.0'>";
    for (int i = 0; i < 100; i++)
        strcat(deep, "<bsdf type='twosided'>");
    check_fault(deep, "is nested more than 64 deep");
    const struct scene_options options = scene_real_options();
    capture_begin();
    CHECK(!scene_read(scene_path("none.xml"), &options));
    CHECK(!scene_read(scene_path("none.usd"), &options));
    capture_end();
    CHECK(captured_has("none.xml: cannot be read") && captured_has("none.usd: is not a scene format"));
}

static void stray_text(void) {
    struct scene *s = parse("<scene version='3.0.0'>\n words " SENSOR " more</scene>", NULL, NULL);
    CHECK(s && captured_has("scene.xml:2: text inside <scene> means nothing"));
    scene_destroy(s);
}

int main(void) {
    scene_folder_open();
    film();
    sampler();
    sampler_replaced();
    integrator_choice();
    faults();
    stray_text();
    scene_folder_close();
    return check_result();
}
