// SPDX-License-Identifier: Apache-2.0
// Scenes that are hardly there, or far too large: triangles without area, slivers, a ground of
// 1000 km, one pixel, one sample, views along a surface, lights that touch one, nothing at all.
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;

static const char sky[] = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
static const char grey[] = "<bsdf type='diffuse'><rgb name='reflectance' value='0.8'/></bsdf>";
static const char lookat[] = "<lookat origin='%s' target='%s' up='0,0.6,0.8'/>";

// A camera with a small angle of view that sees one spot, and what stands around it.
static void write_scene(const char *from, const char *at, double near, const char *body, char *text,
                        size_t n) {
    char view[256];
    snprintf(view, sizeof view, lookat, from, at);
    snprintf(text, n,
             "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'>"
             "<float name='fov' value='1e-4'/><float name='near_clip' value='%g'/>"
             "<float name='far_clip' value='1e7'/><transform name='to_world'>%s</transform>"
             "<film type='hdrfilm'><integer name='width' value='4'/>"
             "<integer name='height' value='4'/><rfilter type='box'/></film></sensor>%s</scene>", near, view, body);
}

static void see(const char *name, const char *from, const char *at, double near, const char *body,
                double expected, double floor) {
    const struct job_options o = {.spp = full_mode() ? 4096 : 256, .variance = true,
                                  .seed = (uint32_t)ztable_count};
    struct render_result result;
    struct image im;
    char text[8192];
    write_scene(from, at, near, body, text, sizeof text);
    render_text(text, &o, &im, &result);
    CHECK(result.truncated == 0);
    ztable_add(name, expected, measure(&im, 'G'), floor);
    image_finish(&im);
}

__attribute__((format(printf, 1, 2))) static const char *join(const char *format, ...) {
    static char texts[4][4096]; // so that one may stand in another
    static unsigned next;
    char *text = texts[next++ % 4];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof texts[0], format, args);
    va_end(args);
    return text;
}

// ---- triangles ------------------------------------------------------------------------------

static const char mesh[] =
    "<shape type='obj'><string name='filename' value='mesh.obj'/>"
    "<boolean name='face_normals' value='true'/>%s%s</shape>";
static const char half[] = "<bsdf type='diffuse'><rgb name='reflectance' value='0.5'/></bsdf>";
static const char glow[] = "<emitter type='area'><rgb name='radiance' value='1'/></emitter>";

// An octahedron, seen from inside.
#define ROOM_VERTICES "v 2 0 0\nv -2 0 0\nv 0 2 0\nv 0 -2 0\nv 0 0 2\nv 0 0 -2\n"
#define ROOM_FACES "f 1 5 3\nf 3 5 2\nf 2 5 4\nf 4 5 1\nf 3 6 1\nf 2 6 3\nf 4 6 2\nf 1 6 4\n"

// Walls of albedo 0.5 that emit 1 in a closed room: 2.
static void rooms(void) {
    scene_write("mesh.obj", ROOM_VERTICES ROOM_FACES);
    see("room", "0.1,0.2,0.3", "1,1,1", 1e-2, join(mesh, half, glow), 2, 1e-6);
    // points, lines, twice the same corner
    scene_write("mesh.obj", ROOM_VERTICES "v 0.5 0.5 0.5\nv 1.5 1.5 1.5\nv 1 1 1\n" ROOM_FACES
                            "f 7 7 7\nf 7 8 9\nf 1 1 3\nf 7 8 8\n");
    see("room with triangles of no area", "0.1,0.2,0.3", "1,1,1", 1e-2, join(mesh, half, glow), 2,
        1e-6);
    // each face is cut in three at a point 1e-6 or 1e-3 from its edge
    char text[4096] = ROOM_VERTICES;
    const int faces[8][3] = {{1, 5, 3}, {3, 5, 2}, {2, 5, 4}, {4, 5, 1},
                             {3, 6, 1}, {2, 6, 3}, {4, 6, 2}, {1, 6, 4}};
    const double p[7][3] = {{0}, {2, 0, 0}, {-2, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 2},
                            {0, 0, -2}};
    size_t used = strlen(text);
    for (int i = 0; i < 8; i++) {
        const double *a = p[faces[i][0]], *b = p[faces[i][1]], *c = p[faces[i][2]];
        const double h = i % 2 ? 1e-6 : 1e-3;
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "v %.9g %.9g %.9g\nf %d %d -1\nf %d %d -1\nf %d %d -1\n",
                                 0.5 * (1 - h) * (a[0] + b[0]) + h * c[0],
                                 0.5 * (1 - h) * (a[1] + b[1]) + h * c[1],
                                 0.5 * (1 - h) * (a[2] + b[2]) + h * c[2], faces[i][0], faces[i][1],
                                 faces[i][1], faces[i][2], faces[i][2], faces[i][0]);
    }
    scene_write("mesh.obj", text);
    see("room of slivers 1:1000 and 1:1e6", "0.1,0.2,0.3", "1,1,1", 1e-2, join(mesh, half, glow), 2,
        1e-6);
}

// Triangles without area change no bit of a picture.
static void no_area_changes_nothing(void) {
    const struct job_options o = {.spp = 16, .variance = true};
    const char *const files[] = {ROOM_VERTICES ROOM_FACES,
                                 ROOM_VERTICES ROOM_FACES "v 0.5 0.5 0.5\nv 1.5 1.5 1.5\nv 1 1 1\n"
                                                          "f 7 7 7\nf 7 8 9\nf 1 1 3\nf 7 8 8\n"};
    struct render_result result;
    struct image im[2];
    char text[8192];
    for (int i = 0; i < 2; i++) {
        scene_write("mesh.obj", files[i]);
        write_scene("0.1,0.2,0.3", "1,1,1", 1e-2,
                    join("%s<emitter type='point'/>", join(mesh, half, "")), text, sizeof text);
        render_text(text, &o, &im[i], &result);
    }
    CHECK(memcmp(im[0].pixels, im[1].pixels, 16 * (size_t)im[0].channels * sizeof(float)) == 0);
    image_finish(&im[0]);
    image_finish(&im[1]);
}

// ---- a ground of 1000 km --------------------------------------------------------------------

static void huge_ground(void) {
    const char ground[] = "<shape type='obj'><string name='filename' value='mesh.obj'/>%s"
                          "</shape>%s";
    const char *const from[] = {"0,1,0", "3,0.01,-2", "0,100,0"};
    const char *const at[] = {"0.2,0,0.5", "4,0,-2", "1e4,0,0"};
    scene_write("mesh.obj", "v -5e5 0 -5e5\nv -5e5 0 5e5\nv 5e5 0 5e5\nv 5e5 0 -5e5\n"
                            "f 1 2 3\nf 1 3 4\n");
    for (int i = 0; i < 3; i++)
        see(join("ground of 1e6 under a sky, from %s", from[i]), from[i], at[i], 1e-4,
            join(ground, grey, sky), 0.8, 1e-6);
    // Positions there have steps of 1/64. Twice that over the distance is the lamp's relative error.
    const char lamp[] = "<emitter type='point'><point name='position' x='%d' y='%d' z='%d'/>"
                        "<rgb name='intensity' value='%d'/></emitter>";
    for (int d = 1; d <= 1000; d *= 10)
        see(join("ground of 1e6 under a lamp %d away", 3 * d), "123456,1,-234567", "123456,0,-234566",
            1e-4, join(ground, grey, join(lamp, 123456 + d, 2 * d, -234566 - 2 * d, 9 * d * d)),
            0.8 / M_PI * 2 / 3, 0.17 / (3 * d) / 32);
}

// ---- views and places -----------------------------------------------------------------------

static void grazing_views(void) {
    const double degrees[] = {89, 89.99, 89.9999};
    const char *const materials[] = {
        grey, "<bsdf type='thindielectric'/>",
        "<bsdf type='conductor'><string name='material' value='none'/></bsdf>"};
    const double expected[] = {0.8, 1, 1};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            char from[128], name[96];
            const double theta = degrees[k] * M_PI / 180;
            snprintf(from, sizeof from, "%.9g,%.9g,0", 10 * sin(theta), 10 * cos(theta));
            snprintf(name, sizeof name, "%s at %g degrees",
                     i == 0 ? "diffuse" : i == 1 ? "thin pane" : "mirror", degrees[k]);
            see(name, from, "0,0,0", 1e-2,
                join("<shape type='rectangle'><transform name='to_world'><scale value='50'/>"
                     "<rotate x='1' angle='-90'/></transform>%s</shape>%s", materials[i], sky),
                expected[i], 1e-6);
        }
}

static void inside_of_shapes(void) {
    // inside glass radiance is n^2 times that outside, and straight on there is nothing lost
    see("inside a glass sphere", "0,0,0", "1,2,3", 1e-2,
        join("<shape type='sphere'><bsdf type='dielectric'><float name='int_ior' value='1.5'/>"
             "<float name='ext_ior' value='1'/></bsdf></shape>%s", sky), 2.25, 1e-6);
    see("inside a black cube", "0,0,0", "1,2,3", 1e-2,
        join("<shape type='cube'><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>"
             "</shape>%s", sky), 0, 0);
    see("inside a sphere that shines outwards", "0,0,0", "1,2,3", 1e-2,
        join("<shape type='sphere'>%s</shape>%s", glow, sky), 0, 0);
    see("on a surface, looking out", "0,0,0", "1,2,3", 1e-2,
        join("<shape type='rectangle'>%s</shape>%s", grey, sky), 1, 0);
}

static void touching_lights(void) {
    const char floor[] = "<shape type='rectangle'><transform name='to_world'><scale value='9'/>"
                         "<rotate x='1' angle='-90'/></transform>%s</shape>";
    char ground[512];
    snprintf(ground, sizeof ground, floor, grey);
    see("light in the plane of the floor", "0,1,0.1", "0,0,0", 1e-3,
        join("%s<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>"
             "<translate x='3'/></transform>%s</shape>", ground, glow), 0, 0);
    // 2x2 at height h straight above its middle: all but a share of 2 h^2 / pi of the hemisphere
    see("light 1e-4 above the floor", "0,5e-5,0", "1e-6,0,0", 1e-7,
        join("%s<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/>"
             "<translate y='1e-4'/></transform>%s</shape>", ground, glow), 0.8, 1e-6);
}

// ---- hardly a picture -----------------------------------------------------------------------

static void one_pixel_one_sample(void) {
    for (const struct entry *const *s = samplers.entries; *s; s++)
        for (int spp = 1; spp <= 2; spp++) {
            const struct job_options o = {
                .spp = spp, .variance = true, .aovs = "albedo,N,Z",
                .reading = {.sampler = (*s)->name, .width = 1, .height = 1}};
            struct render_result result;
            struct image im;
            char text[8192];
            write_scene("0,1,0", "0,0,0", 1e-2,
                        join("<shape type='rectangle'><transform name='to_world'>"
                             "<rotate x='1' angle='-90'/></transform>%s</shape>%s", grey, sky),
                        text, sizeof text);
            render_text(text, &o, &im, &result);
            CHECK(im.width == 1 && im.height == 1 && result.samples == (uint64_t)spp);
            for (int c = 0; c < im.channels; c++)
                CHECK(isfinite(im.pixels[c]));
            CHECK(im.pixels[0] >= 0 && im.pixels[0] < 4);
            image_finish(&im);
        }
}

static void nothing_is_black(void) {
    see("empty scene", "0,1,0", "0,0,0", 1e-2, "", 0, 0);
    see("no light", "0,1,0", "0,0,0", 1e-2, "<shape type='sphere'/>", 0, 0);
    see("nothing but a sky", "0,1,0", "0,0,0", 1e-2, sky, 1, 0);
}

// Refused, with one message that names the place and holds the words.
static void refused(const char *body, const char *words) {
    const struct job_options o = {.spp = 1, .scene = scene_path("scene.xml")};
    struct job job;
    char text[8192];
    write_scene("0,1,0", "0,0,0", 1e-2, body, text, sizeof text);
    scene_write("scene.xml", text);
    capture_begin();
    const bool opened = job_open(&job, &o);
    capture_end();
    CHECK(!opened && captured_has("error: ") && captured_has(words));
    if (opened || !captured_has(words))
        printf("%s: found: %s\n", words, captured);
}

static void worthless_files_are_refused(void) {
    const char obj[] = "<shape type='obj'><string name='filename' value='mesh.obj'/>%s</shape>";
    const char ply[] = "<shape type='ply'><string name='filename' value='mesh.ply'/></shape>";
    scene_write("mesh.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
    refused(join(obj, ""), "mesh.obj:2: ");
    scene_write("mesh.obj", "v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n");
    refused(join(obj, ""), "mesh.obj:2: ");
    scene_write("mesh.obj", "");
    refused(join(obj, ""), "holds no faces");
    scene_write("mesh.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
    refused(join(obj, glow), "has no area");
    scene_write("mesh.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\n"
                            "property float y\nproperty float z\nelement face 0\n"
                            "property list uchar int vertex_indices\nend_header\n");
    refused(ply, "holds no faces");
    scene_write("mesh.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                            "property float y\nproperty float z\nelement face 1\n"
                            "property list uchar int vertex_indices\nend_header\n"
                            "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n");
    refused(ply, "mesh.ply:11: ");
    refused(join("<shape type='rectangle'><transform name='to_world'><scale x='0'/></transform>"
                 "%s</shape>", glow), "transform has no inverse");
}

int main(void) {
    scene_folder_open();
    rooms();
    no_area_changes_nothing();
    huge_ground();
    grazing_views();
    inside_of_shapes();
    touching_lights();
    one_pixel_one_sample();
    nothing_is_black();
    worthless_files_are_refused();
    scene_folder_close();
    ztable_finish(FALSE_ALARMS);
    return check_result();
}
