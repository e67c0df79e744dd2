// SPDX-License-Identifier: Apache-2.0
// Closed rooms far from the origin shine as at it: radiance 2 from walls of albedo 0.5 that emit 1.
// Offsets stand in transforms, which are kept in double; vertices that a file gives far away have
// lost their digits before, and a warning says so.
//
// Each of the 24 rows is held to 3 standard errors: 0.065 are expected outside, so that a new choice of
// seeds fails in 6.3 % (--full: 16 times the samples, by which a bias would stand out). The sum of
// squares of all rows has chi-square's bounds.
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3; // of chi-square over all rows

static const char bsdf[] = "<bsdf type='diffuse'><rgb name='reflectance' value='0.5'/></bsdf>";
static const char emitter[] =
    "<emitter type='area'><rgb name='radiance' value='1'/></emitter>";
static const char point_light[] =
    "<emitter type='point'><transform name='to_world'>%s</transform>"
    "<rgb name='intensity' value='3.14159265'/></emitter>";

// %s: the move; lit: by a light at the centre, not by the walls.
static const struct {
    const char *name, *shape;
    bool lit;
    double radiance;
} rooms[] = {
    {"sphere", "<shape type='sphere'><boolean name='flip_normals' value='true'/>"
               "<transform name='to_world'>%s</transform>%s%s</shape>", false, 2},
    {"sphere, light at its centre", "<shape type='sphere'><boolean name='flip_normals' value='true'/>"
               "<transform name='to_world'>%s</transform>%s%s</shape>", true, 1},
    {"cube", "<shape type='cube'><boolean name='flip_normals' value='true'/>"
             "<transform name='to_world'>%s</transform>%s%s</shape>", false, 2},
    {"mesh", "<shape type='obj'><string name='filename' value='room.obj'/>"
             "<boolean name='face_normals' value='true'/><transform name='to_world'>%s</transform>%s%s</shape>", false, 2},
    {"open cylinder between disks",
     "<shape type='cylinder'><boolean name='flip_normals' value='true'/>"
     "<transform name='to_world'><translate z='-0.5'/><scale value='2'/>%1$s</transform>%2$s%3$s</shape>"
     "<shape type='disk'><transform name='to_world'><scale value='2'/><translate z='-1'/>%1$s"
     "</transform>%2$s%3$s</shape>"
     "<shape type='disk'><boolean name='flip_normals' value='true'/><transform name='to_world'>"
     "<scale value='2'/><translate z='1'/>%1$s</transform>%2$s%3$s</shape>", false, 2},
};

// An octahedron, seen from inside.
static const char room_mesh[] = "v 2 0 0\nv -2 0 0\nv 0 2 0\nv 0 -2 0\nv 0 0 2\nv 0 0 -2\n"
                                "f 1 5 3\nf 3 5 2\nf 2 5 4\nf 4 5 1\n"
                                "f 3 6 1\nf 2 6 3\nf 4 6 2\nf 1 6 4\n";

static void test_room(size_t i, const char *move, const char *more, const char *where) {
    const int spp = full_mode() ? 1024 : 64;
    const struct job_options o = {.spp = spp, .variance = true, .seed = (uint32_t)ztable_count};
    char shape[2048], light[512], text[4096], name[96];
    struct render_result result;
    struct image im;
    snprintf(shape, sizeof shape, rooms[i].shape, move, bsdf, rooms[i].lit ? "" : emitter);
    snprintf(light, sizeof light, point_light, move);
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'>"
             "<float name='fov' value='100'/><transform name='to_world'>%s</transform>"
             "<film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='8'/>"
             "<rfilter type='box'/></film></sensor>%s%s%s</scene>",
             move, shape, rooms[i].lit ? light : "", more);
    render_text(text, &o, &im, &result);
    snprintf(name, sizeof name, "%s, %s", rooms[i].name, where);
    // single precision resolves the distance to the light to 1e-6 of it; the square doubles that
    ztable_add(name, rooms[i].radiance, measure(&im, 'G'), 4e-6);
    image_finish(&im);
}

static void rooms_shine_anywhere(size_t i) {
    const double offsets[] = {0, 1e2, 1e4, 1e6};
    char move[128], name[64];
    for (int k = 0; k < 4; k++) {
        snprintf(move, sizeof move, "<rotate y='1' angle='30'/><translate x='%g' y='%g' z='%g'/>",
                 offsets[k], -0.7 * offsets[k], 0.4 * offsets[k]);
        snprintf(name, sizeof name, "%g away", offsets[k]);
        test_room(i, move, "", name);
    }
    // with something at the origin, there is no better middle: positions are good to 1/30 or so
    if (!rooms[i].lit)
        test_room(i, "<scale value='1000'/><translate x='1e6' y='-7e5' z='4e5'/>",
                  "<shape type='sphere'/>", "of 1000, 1e6 from a sphere");
}

// ---- the warning ----------------------------------------------------------------------------

static bool warns(double offset, double in_transform) {
    char mesh[512], text[512];
    snprintf(mesh, sizeof mesh, "v %.9g 0 0\nv %.9g 0 0\nv %.9g 1 0\nf 1 2 3\n", offset, offset + 1,
             offset);
    scene_write("far.obj", mesh);
    snprintf(text, sizeof text,
             "<shape type='obj'><string name='filename' value='far.obj'/>"
             "<transform name='to_world'><translate x='%.9g'/></transform></shape>", in_transform);
    struct scene *s = scene_parse(text);
    CHECK(s);
    scene_destroy(s);
    const bool said = captured_has("warning: ") && captured_has("scene.xml:2: ") &&
                      captured_has("floats resolve only");
    CHECK(said || captured[0] == '\0');
    return said;
}

static void far_vertices_warn(void) {
    CHECK(warns(1e6, 0));
    CHECK(warns(2e4, 0));
    CHECK(warns(2e4, -2e4)); // moving it back does not bring back the digits
    CHECK(!warns(1e3, 0));
    CHECK(!warns(0, 1e6));
}

int main(void) {
    scene_folder_open();
    scene_write("room.obj", room_mesh);
    for (size_t i = 0; i < sizeof rooms / sizeof *rooms; i++)
        rooms_shine_anywhere(i);
    far_vertices_warn();
    scene_folder_close();
    ztable_finish_within_three(FALSE_ALARMS);
    return check_result();
}
