// SPDX-License-Identifier: Apache-2.0
// What of a scene can be edited: objects, conversion of plain materials, shapes of blocks.
#include "driver/edit_plan.h"

#include <string.h>

#include "driver/job.h"
#include "scene_text.h"
#include "world/world.h"

static const char BODY[] =
    "<bsdf type='twosided' id='coated'><bsdf type='roughplastic'/></bsdf>"
    "<bsdf type='mask' id='leaf'><float name='opacity' value='0.5'/><bsdf type='bumpmap'>"
    "<texture type='checkerboard'/><bsdf type='editable'><integer name='bins' value='16'/>"
    "<integer name='bins_b' value='8'/></bsdf></bsdf></bsdf>"
    "<shape type='sphere' id='ball'><bsdf type='phong'><float name='exponent' value='64'/></bsdf></shape>"
    "<shape type='sphere'><ref id='coated'/></shape>"
    "<shape type='rectangle'><ref id='coated'/></shape>"
    "<shape type='rectangle'><ref id='leaf'/></shape>"
    "<shape type='rectangle' id='plain'><bsdf type='dielectric'/></shape>";

static const struct bsdf_point point = {.at = {.uv = {0.3f, 0.3f}},
                                        .frame = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                        .dpdu = {1, 0, 0}, .dpdv = {0, 1, 0}};

static void names_objects_and_blocks(void) {
    static const char *const names[] = {"coated", "ball"};
    struct scene *s = scene_parse(BODY);
    struct edit_plan p;
    CHECK(s && edit_convert(s, names, 2, 0));
    struct world *w = world_create(s, 1);
    CHECK(w && edit_plan_init(&p, s));
    CHECK(p.count == 3);
    CHECK(strcmp(p.objects[0].name, "ball") == 0 && strcmp(p.objects[1].name, "coated") == 0 &&
          strcmp(p.objects[2].name, "leaf") == 0);
    struct tensor_block b;
    edit_plan_block(&p, 0, 0, &b);
    CHECK(b.axis_count == 1 && b.coefficients == 256 && strcmp(b.axes[0].name, "theta_r") == 0);
    edit_plan_block(&p, 2, 0, &b);
    CHECK(b.axis_count == 2 && b.coefficients == 128 && b.axes[1].bins == 8 &&
          b.axes[1].basis == TENSOR_HAT && b.axes[1].edges[7] == CURVE_END);
    struct json *meta = json_new_object();
    edit_plan_describe(&p, meta, NULL);
    const struct json *object = json_at(json_get(meta, "objects"), 1);
    CHECK(strcmp(json_text(json_get(object, "model")), "cooktorrance") == 0);
    CHECK(json_count(json_get(json_get(object, "form"), "terms")) == 2);
    json_destroy(meta);
    edit_plan_finish(&p);
    world_destroy(w);
    scene_destroy(s);
}

// A wrapped material's evaluation is the sum of the values inside times curves and factor.
static void sees_through_wrappers(void) {
    static const char *const names[] = {"coated"};
    struct scene *s = scene_parse(BODY);
    CHECK(s && edit_convert(s, names, 1, 0));
    struct world *w = world_create(s, 1);
    struct closure_stack stack;
    for (int shape = 1; shape < 4; shape += 2)
        for (int side = -1; side < (shape == 1 ? 2 : 1); side += 2) {
            const float z = shape == 1 ? (float)side : 1;
            const vec3 wo = normalize(v3(0.3f, 0.2f, z)), wi = normalize(v3(0.1f, -0.4f, z));
            stack.used = 0;
            const struct closure *c = bsdf_resolve(s->shapes[shape].bsdf, &point, wo, &stack);
            float pdf, factor = 1;
            vec3 inner_wi = wi;
            const spectrum expected = closure_eval(c, wi, &pdf);
            const struct closure *inner = editable_inside(c, &inner_wi, &factor);
            CHECK(inner && spectrum_max(expected) > 0);
            const spectrum found = closure_eval(inner, inner_wi, &pdf) * factor;
            for (int k = 0; k < 3; k++)
                CHECK_NEAR((double)found[k], (double)expected[k], 1e-6 * (double)expected[k]);
            CHECK(edit_plan_find(&(struct edit_plan){0}, editable_owner(inner)) == EDIT_NONE);
        }
    world_destroy(w);
    scene_destroy(s);
}

static void refuses_what_has_no_form(void) {
    static const char *const glass[] = {"plain"}, *const nobody[] = {"nobody"};
    struct scene *s = scene_parse(BODY);
    capture_begin();
    CHECK(!edit_convert(s, glass, 1, 0));
    CHECK(strstr(capture_end(), "dielectric has no editable form"));
    capture_begin();
    CHECK(!edit_convert(s, nobody, 1, 0));
    CHECK(strstr(capture_end(), "no material or shape of that id"));
    scene_destroy(s);
}

// The look is kept: reflected light of the plain material and of its editable form agree.
static void keeps_the_look(void) {
    static const struct {
        const char *material;
        double tolerance; // of the directional albedo
    } cases[] = {
        {"<bsdf type='diffuse' id='m'/>", 1e-3},
        {"<bsdf type='phong' id='m'><float name='exponent' value='20'/></bsdf>", 0.01},
        {"<bsdf type='blinnphong' id='m'/>", 0.01},
        {"<bsdf type='cooktorrance' id='m'><string name='material' value='Au'/></bsdf>", 0.01},
        {"<bsdf type='ward' id='m'><float name='alpha_u' value='0.3'/></bsdf>", 0.01},
        {"<bsdf type='schlick' id='m'/>", 0.02},
        {"<bsdf type='orennayar' id='m'/>", 0.02},
        {"<bsdf type='eon' id='m'/>", 0.07},
        {"<bsdf type='ashikhminshirley' id='m'/>", 0.1},
        {"<bsdf type='roughconductor' id='m'><string name='material' value='Cu'/></bsdf>", 0.03},
        {"<bsdf type='roughconductor' id='m'><string name='distribution' value='ggx'/></bsdf>", 0.03},
        {"<bsdf type='conductor' id='m'><string name='material' value='Ag'/></bsdf>", 0.03},
        {"<bsdf type='plastic' id='m'/>", 0.08},
        {"<bsdf type='roughplastic' id='m'/>", 0.08},
        {"<bsdf type='principled' id='m'/>", 0.13},
    };
    static const char *const name[] = {"m"};
    const vec3 wo = normalize(v3(0.4f, 0, 0.9f));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char body[512];
        snprintf(body, sizeof body, "%s<shape type='rectangle'><ref id='m'/></shape>", cases[i].material);
        double albedo[2];
        for (int editable = 0; editable < 2; editable++) {
            struct scene *s = scene_parse(body);
            struct closure_stack stack = {0};
            capture_begin();
            CHECK(!editable || edit_convert(s, name, 1, 0));
            capture_end();
            struct world *w = world_create(s, 1);
            const struct closure *c = bsdf_resolve(s->shapes[0].bsdf, &point, wo, &stack);
            double sum = 0;
            for (int n = 0; n < 20000; n++) {
                struct bsdf_sample b;
                const float u = ((float)n + 0.5f) / 20000;
                const struct vec2 u2 = {fmodf((float)n * 0.7548777f, 1), fmodf((float)n * 0.5698403f, 1)};
                sum += closure_sample(c, u, u2, &b) ? (double)b.weight[0] / 20000 : 0;
            }
            albedo[editable] = sum;
            world_destroy(w);
            scene_destroy(s);
        }
        CHECK_NEAR(albedo[1], albedo[0], cases[i].tolerance);
    }
}

int main(void) {
    scene_folder_open();
    names_objects_and_blocks();
    sees_through_wrappers();
    refuses_what_has_no_form();
    keeps_the_look();
    scene_folder_close();
    return check_result();
}
