// SPDX-License-Identifier: Apache-2.0
// Shapes, groups and instances, lights in shapes, and the moving of far scenes to the origin.
#include "scene/summary.h"
#include "scene_text.h"

static void check_point(const struct transform *t, double x, double y, double z, double X,
                        double Y, double Z) {
    const double p[3] = {x, y, z};
    double q[3];
    transform_point(t, p, q);
    CHECK_NEAR(q[0], X, 1e-12);
    CHECK_NEAR(q[1], Y, 1e-12);
    CHECK_NEAR(q[2], Z, 1e-12);
}

static void kinds(void) {
    struct scene *s = scene_parse(
        "<shape type='rectangle' id='r'><boolean name='flip_normals' value='true'/></shape>"
        "<shape type='cube'/>"
        "<shape type='sphere'><point name='center' x='1' y='2' z='3'/>"
        "<float name='radius' value='2'/><transform name='to_world'><scale x='2'/></transform>"
        "</shape>"
        "<shape type='disk'/>"
        "<shape type='cylinder'><point name='p0' value='0 0 1'/><point name='p1' value='0 4 1'/>"
        "<float name='radius' value='.5'/></shape>");
    CHECK(s && s->shape_count == 5 && s->light_count == 0);
    if (!s) {
        printf("%s", captured);
        return;
    }
    CHECK(s->shapes[0].kind == SHAPE_MESH && s->shapes[0].mesh.triangle_count == 2);
    CHECK(s->shapes[0].flip_normals && strcmp(s->shapes[0].name, "r") == 0);
    CHECK(s->shapes[1].mesh.triangle_count == 12 && *s->shapes[1].name == '\0');
    CHECK(s->shapes[2].kind == SHAPE_SPHERE && s->shapes[3].kind == SHAPE_DISK);
    check_point(&s->shapes[2].to_world, 0, 0, 0, 2, 2, 3); // centre, then to_world
    check_point(&s->shapes[2].to_world, 1, 0, 0, 6, 2, 3);
    check_point(&s->shapes[2].to_world, 0, 1, 0, 2, 4, 3);
    const struct transform *c = &s->shapes[4].to_world;
    check_point(c, 0, 0, 0, 0, 0, 1);
    check_point(c, 0, 0, 1, 0, 4, 1);
    const double x[3] = {1, 0, 0};
    double side[3];
    transform_vector(c, x, side);
    CHECK_NEAR(sqrt(side[0] * side[0] + side[1] * side[1] + side[2] * side[2]), .5, 1e-12);
    CHECK_NEAR(side[1], 0, 1e-12);
    CHECK(transform_determinant3(c) > 0);
    CHECK(s->centre[0] == 0 && s->centre[1] == 0 && s->centre[2] == 0);
    // one default material for all
    CHECK(s->bsdf_count == 1 && s->shapes[0].bsdf == s->shapes[4].bsdf);
    check_colour(PARAM(struct texture_ref, s->bsdfs[0], "reflectance").value, .5, .5, .5, 0);
    scene_destroy(s);
}

static void emitters(void) {
    struct scene *s = scene_parse(
        "<emitter type='area' id='lamp'><rgb name='radiance' value='2'/></emitter>"
        "<emitter type='constant'/>"
        "<shape type='cube' id='a'><ref id='lamp'/></shape>"
        "<shape type='sphere'><ref id='lamp'/><bsdf type='diffuse'/></shape>"
        "<shape type='cube' id='c'><emitter type='area'>"
        "<string name='group' value='warm'/></emitter></shape>"
        "<emitter type='point' id='bulb'/>");
    CHECK(s && s->light_count == 5);
    if (!s) {
        printf("%s", captured);
        return;
    }
    CHECK(s->shapes[0].light == 0 && s->lights[0].shape == 0);
    CHECK(s->shapes[1].light == 1 && s->lights[1].shape == 1);
    CHECK(s->lights[0].object != s->lights[1].object); // one per shape
    CHECK(strcmp(s->lights[0].name, "a") == 0 && strcmp(s->lights[1].name, "lamp") == 0);
    CHECK(strcmp(s->lights[2].name, "c") == 0 && strcmp(s->lights[2].group, "warm") == 0);
    CHECK(strcmp(s->lights[3].name, "constant.3") == 0 && s->lights[3].shape == SCENE_NONE);
    CHECK(strcmp(s->lights[4].name, "bulb") == 0 && !s->lights[4].group);
    // a light that names no material is black
    check_colour(PARAM(struct texture_ref, s->shapes[0].bsdf, "reflectance").value, 0, 0, 0, 0);
    check_colour(PARAM(struct texture_ref, s->shapes[1].bsdf, "reflectance").value, .5, .5, .5, 0);
    scene_destroy(s);
}

static void groups(void) {
    struct scene *s = scene_parse(
        "<shape type='instance' id='one'><ref id='g'/></shape>" // forward
        "<shape type='shapegroup' id='g'><shape type='cube'/><shape type='sphere'/></shape>"
        "<shape type='instance'><ref id='g'/><transform name='to_world'><translate x='5'/>"
        "</transform></shape>"
        "<shape type='instance'><shape type='shapegroup'><shape type='disk'/></shape></shape>"
        "<shape type='rectangle'/>");
    CHECK(s && s->group_count == 2 && s->instance_count == 3 && s->shape_count == 4);
    if (!s) {
        printf("%s", captured);
        return;
    }
    CHECK(s->shapes[0].group == 0 && s->shapes[1].group == 0 && s->shapes[2].group == 1);
    CHECK(s->shapes[3].group == SCENE_NONE);
    CHECK(s->instances[0].group == 0 && s->instances[1].group == 0 && s->instances[2].group == 1);
    check_point(&s->instances[1].to_world, 0, 0, 0, 5, 0, 0);
    CHECK(s->bounds_min[0] == -1 && s->bounds_max[0] == 6);
    struct scene_summary sum;
    scene_summary_init(&sum, s);
    CHECK(sum.triangles == 14 && sum.placed_triangles == 2 + 2 * 12 && sum.instances == 3);
    CHECK(sum.meshes == 2 && sum.quadrics == 2 && sum.groups == 2 && !sum.recentred);
    CHECK(sum.vertices == 28 && sum.mesh_bytes > 0);
    bool found = false;
    for (uint32_t i = 0; i < sum.use_count; i++)
        found |= strcmp(sum.uses[i].kind, "bsdf") == 0 && sum.uses[i].count == 1;
    CHECK(found);
    scene_summary_finish(&sum);
    scene_destroy(s);
}

// A scene far away is moved to the origin in double: its shape keeps all its digits.
static void far_away(void) {
    char body[1024];
    snprintf(body, sizeof body, "<shape type='rectangle'><transform name='to_world'>"
             "<translate x='1000000.1' y='-2000000' z='.5'/></transform></shape>"
             "<shape type='sphere'><point name='center' x='1000000.1' y='-2000000' z='.7'/></shape>"
             "<shape type='instance'><transform name='to_world'>"
             "<translate x='1000000.1' y='-2000000' z='.5'/></transform>"
             "<shape type='shapegroup'><shape type='rectangle'/></shape></shape>");
    struct scene *s = scene_parse(body);
    CHECK(s);
    if (!s) {
        printf("%s", captured);
        return;
    }
    CHECK(s->centre[0] == 1000000 && s->centre[1] == -2000000 && s->centre[2] == 1);
    CHECK_NEAR(s->shapes[0].mesh.positions[0][0], 0.1 - 1, 1e-7);
    CHECK_NEAR(s->shapes[0].mesh.positions[0][1], -1, 1e-7);
    CHECK_NEAR(s->shapes[0].mesh.positions[0][2], -.5, 1e-7);
    CHECK_NEAR(s->shapes[1].to_world.m[0][3], 0.1, 1e-9);
    CHECK_NEAR(s->shapes[1].to_world.m[2][3], -.3, 1e-12);
    CHECK_NEAR(s->instances[0].to_world.m[0][3], 0.1, 1e-9);
    CHECK(s->bounds_max[0] <= 1.2f && s->bounds_min[0] >= -1);
    CHECK(!captured_has("warning")); // the file gives no far vertices
    scene_destroy(s);
}

// A group whose own coordinates are far away, brought back by its instance.
static void far_group(void) {
    struct scene *s = scene_parse(
        "<shape type='shapegroup' id='g'><shape type='cube'><transform name='to_world'>"
        "<translate x='1e6'/></transform></shape></shape>"
        "<shape type='instance'><ref id='g'/><transform name='to_world'><translate x='-1e6'/>"
        "<scale value='3'/></transform></shape>");
    CHECK(s);
    if (!s)
        return;
    CHECK(s->centre[0] == 0 && s->bounds_min[0] == -3 && s->bounds_max[0] == 3);
    CHECK(fabsf(s->shapes[0].mesh.positions[0][0]) == 1);
    check_point(&s->instances[0].to_world, 1, 1, 1, 3, 3, 3);
    scene_destroy(s);
}

static void far_vertices(void) {
    scene_write("far.obj", "v 20000 0 0\nv 20001 0 0\nv 20000 1 0\nf 1 2 3\n");
    scene_write("near.obj", "v 100 0 0\nv 101 0 0\nv 100 1 0\nf 1 2 3\n");
    struct scene *s = scene_parse("<shape type='obj'><string name='filename' value='far.obj'/></shape>");
    CHECK(s && captured_has("scene.xml:2: vertices stand") && s->centre[0] == 20000.5);
    if (s)
        CHECK(s->shapes[0].mesh.positions[1][0] == .5f);
    scene_destroy(s);
    s = scene_parse("<shape type='obj'><string name='filename' value='near.obj'/></shape>");
    CHECK(s && !captured_has("vertices"));
    scene_destroy(s);
}

// A scene scaled by a power of two is the same scene, bit for bit.
static void scaling(void) {
    for (int far = 0; far < 2; far++) {
        float first[3] = {0};
        for (int e = -20; e <= 20; e += 10) {
            char body[512];
            snprintf(body, sizeof body, "<shape type='cube'><transform name='to_world'>"
                     "<rotate x='1' y='.3' angle='33'/><translate x='%d'/><scale value='%.17g'/>"
                     "</transform></shape>", far ? 1000 : 1, ldexp(1, e));
            struct scene *s = scene_parse(body);
            CHECK(s && (s->centre[0] != 0) == far);
            for (int k = 0; s && k < 3; k++) {
                const float v = ldexpf(s->shapes[0].mesh.positions[3][k], -e);
                CHECK(e == -20 || v == first[k]);
                first[k] = v;
            }
            scene_destroy(s);
        }
    }
}

static void check_fault(const char *body, const char *message) {
    struct scene *s = scene_parse(body);
    CHECK(!s);
    CHECK(captured_has("scene.xml:2: ") && captured_has(message));
    if (!captured_has(message))
        printf("%s\nsays: %sexpected: %s\n", body, captured, message);
    scene_destroy(s);
}

static void faults(void) {
    check_fault("<shape type='spere'/>", "shape \"spere\" is not known; did you mean \"sphere\"?");
    check_fault("<shape type='obj'/>", "lacks the parameter \"filename\"");
    check_fault("<shape type='obj'><string name='filename' value='x.obj'/></shape>",
                "there is no file \"x.obj\"");
    check_fault("<shape type='sphere'><float name='radius' value='0'/></shape>", "\"radius\" is 0");
    check_fault("<shape type='cylinder'><point name='p1' value='0'/></shape>", "p0 and p1 coincide");
    check_fault("<shape type='cube'><bsdf type='diffuse'/><bsdf type='diffuse'/></shape>",
                "a second bsdf in one shape");
    check_fault("<shape type='cube'><emitter type='area'/><emitter type='area'/></shape>",
                "a second emitter in one shape");
    check_fault("<shape type='cube'><sensor type='irradiancemeter'/><sensor type='irradiancemeter'/>"
                "</shape>", "a second sensor in one shape");
    check_fault("<shape type='instance'/>", "an instance holds exactly one shapegroup");
    check_fault("<shape type='instance'><shape type='cube'/></shape>", "exactly one shapegroup");
    check_fault("<shape type='shapegroup'><shape type='instance'/></shape>",
                "a shapegroup cannot hold a instance");
    check_fault("<shape type='shapegroup'><shape type='cube'><emitter type='area'/></shape></shape>",
                "an emitter in a shapegroup");
    check_fault("<emitter type='area'/>", "emitter \"area\" stands in no shape");
    const char *const of_the_scene[] = {"constant", "directional", "point", "spot", "sunsky"};
    for (size_t i = 0; i < sizeof of_the_scene / sizeof *of_the_scene; i++) {
        char body[128], message[128];
        snprintf(body, sizeof body, "<shape type='cube'><emitter type='%s'/></shape>", of_the_scene[i]);
        snprintf(message, sizeof message, "emitter \"%s\" stands in a shape, expected \"area\"",
                 of_the_scene[i]);
        check_fault(body, message);
    }
    check_fault("<emitter type='point' id='p'/><shape type='cube'><ref id='p'/></shape>",
                "emitter \"point\" stands in a shape");
    check_fault("<emitter type='directional'><vector name='direction' value='0 0 0'/></emitter>",
                "\"direction\" is 0 0 0, expected a direction");
    check_fault("<film type='hdrfilm'/>", "a <film> cannot stand directly in a scene");
    CHECK(!scene_parse("<shape type='sphere'><float name='radius' value='1e20'/></shape>"));
    CHECK(captured_has("scene.xml: shapes reach beyond 1e18"));
    CHECK(!scene_parse("<shape type='cube'><transform name='to_world'><scale value='1e200'/>"
                       "</transform></shape>"));
    CHECK(captured_has("scene.xml: shapes reach beyond 1e18"));
    scene_write("bad.obj", "f 1 2 3\n");
    CHECK(!scene_parse("<shape type='obj'><string name='filename' value='bad.obj'/></shape>"));
    CHECK(captured_has("bad.obj"));
}

int main(void) {
    scene_folder_open();
    kinds();
    emitters();
    groups();
    far_away();
    far_group();
    far_vertices();
    scaling();
    faults();
    scene_folder_close();
    return check_result();
}
