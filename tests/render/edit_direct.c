// SPDX-License-Identifier: Apache-2.0
// Precomputed materials under direct light: the tensor times the scene's own curves is the sum over
// the same triangles, light by light.
#include "edit_picture.h"
#include "scene_text.h"

enum { SKY_WIDE = 64, SKY_HIGH = 32 };

// Lamps of several sizes.
static double lamps(int x, int y, int c, const void *ctx) {
    const double sky = y < SKY_HIGH / 2 ? 0.6 + 0.2 * c : 0.15;
    const bool lamp = x > 8 && x < 12 && y > 5 && y < 9, sun = x == 40 && y == 6;
    (void)ctx;
    return sky + (lamp ? 20 - 5 * c : 0) + (sun ? 300 : 0);
}

static const char *scene_of(const char *materials, const char *more) {
    char text[8192];
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='path'/>"
             "<sensor type='perspective'><float name='fov' value='35'/>"
             "<transform name='to_world'><lookat origin='0,3,6' target='0,0.6,0' up='0,1,0'/></transform>"
             "<film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='12'/>"
             "<rfilter type='gaussian'/></film></sensor>"
             "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>"
             "%s"
             "<shape type='sphere'><transform name='to_world'><translate y='1'/></transform>"
             "<ref id='ball'/></shape>"
             "<shape type='rectangle'><transform name='to_world'><scale value='4'/>"
             "<rotate x='1' angle='-90'/></transform><ref id='floor'/></shape>%s</scene>",
             materials, more);
    scene_write("s.xml", text);
    return scene_path("s.xml");
}

static struct edit_options options_of(uint32_t triangles, int spp) {
    return (struct edit_options){.job = {.spp = spp, .threads = 2}, .lights = triangles,
                                 .light_samples = 2};
}

struct identity_case {
    const char *name, *materials;
};

static const struct identity_case cases[] = {
    {"Blinn-Phong and diffuse, hats",
     "<bsdf type='editable' id='ball'><float name='exponent' value='64'/>"
     "<boolean name='fixed_fresnel' value='true'/><rgb name='diffuse_reflectance' value='0.3,0.2,0.1'/>"
     "</bsdf><bsdf type='twosided' id='floor'><bsdf type='editable'>"
     "<string name='model' value='lightview'/></bsdf></bsdf>"},
    {"Cook-Torrance with both curves, boxes",
     "<bsdf type='editable' id='ball'><string name='model' value='cooktorrance'/>"
     "<string name='material' value='Au'/><float name='alpha' value='0.2'/>"
     "<string name='basis' value='box'/><integer name='bins' value='128'/>"
     "<integer name='bins_b' value='32'/></bsdf>"
     "<bsdf type='twosided' id='floor'><bsdf type='editable'><string name='model' value='orennayar'/>"
     "<texture name='specular_reflectance' type='checkerboard'/></bsdf></bsdf>"},
    {"Ashikhmin-Shirley, a bumpy floor",
     "<bsdf type='editable' id='ball'><string name='model' value='ashikhminfresnel'/>"
     "<float name='exponent_u' value='10'/><float name='exponent_v' value='200'/>"
     "<integer name='bins' value='64'/></bsdf>"
     "<bsdf type='bumpmap' id='floor'><texture type='checkerboard'/><bsdf type='editable'>"
     "<string name='model' value='phong'/><float name='exponent' value='30'/></bsdf></bsdf>"},
};

// Points: the same sums to rounding. Triangles: to the error of their shares and of the points that
// the loop averages over.
static void is_the_loop_over_the_same_lights(void) {
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *scene = scene_of(cases[i].materials, "");
        struct edit_picture tensor, loop;
        struct edit_options o = options_of(2500, 2);
        o.tolerance = 1e-3;
        o.as_points = true;
        CHECK(edit_picture_by_tensor(scene, &o, false, &tensor, NULL));
        edit_picture_by_loop(scene, &o, 0, false, &loop);
        const double points = edit_picture_largest(&tensor, &loop);
        edit_picture_free(&tensor);
        edit_picture_free(&loop);
        o.as_points = false;
        CHECK(edit_picture_by_tensor(scene, &o, false, &tensor, NULL));
        edit_picture_by_loop(scene, &o, 3, false, &loop);
        const double triangles = edit_picture_largest(&tensor, &loop);
        const double relmse = edit_picture_relmse(&tensor, &loop);
        printf("%s: largest difference %.1e as points, %.1e as triangles (relMSE %.1e)\n",
               cases[i].name, points, triangles, relmse);
        CHECK(points < 1e-5);
        CHECK(triangles < 3e-3 && relmse < 1e-5);
        edit_picture_free(&tensor);
        edit_picture_free(&loop);
    }
}

int main(void) {
    scene_folder_open();
    edit_picture_write_sky(scene_path("sky.exr"), SKY_WIDE, SKY_HIGH, lamps, NULL);
    is_the_loop_over_the_same_lights();
    scene_folder_close();
    return check_result();
}
