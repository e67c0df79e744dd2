// SPDX-License-Identifier: Apache-2.0
// What is said of textures when a world is made: values that no reflectance has, texels that are no
// numbers, coordinates and attributes that a mesh lacks; each once.
#include "image/image.h"
#include "scene_text.h"
#include "world/world.h"

static const char mesh_head[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nproperty float red\nproperty float green\nproperty float blue\n";
static const char mesh_tail[] = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

// A triangle with the colour (3, 0.5, 0.5) in one corner, without and with texture coordinates.
static void write_meshes(void) {
    char text[1024];
    snprintf(text, sizeof text, "%s%s0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 3 .5 .5\n3 0 1 2\n", mesh_head,
             mesh_tail);
    scene_write("bare.ply", text);
    snprintf(text, sizeof text, "%sproperty float u\nproperty float v\n%s0 0 0 1 0 0 0 0\n"
             "1 0 0 0 1 0 1 0\n0 1 0 3 .5 .5 0 1\n3 0 1 2\n", mesh_head, mesh_tail);
    scene_write("mapped.ply", text);
}

static void write_picture(const char *name, float a, float b) {
    struct image im;
    CHECK(image_init(&im, 2, 2, 3));
    for (int i = 0; i < 12; i++)
        im.pixels[i] = 0.25f;
    im.pixels[4] = a;
    im.pixels[9] = im.pixels[10] = b;
    CHECK(image_write_exr(scene_path(name), &im, NULL));
    image_finish(&im);
}

static int count(const char *text) {
    int n = 0;
    for (const char *at = captured; (at = strstr(at, text)); at++)
        n++;
    return n;
}

// What making the world says of a scene with this body, which begins in line 2.
static bool make(const char *body) {
    struct scene *s = scene_parse(body);
    if (!s) {
        printf("%s\n", captured);
        exit(1);
    }
    capture_begin();
    struct world *w = world_create(s, 1);
    capture_end();
    const bool made = w != NULL;
    world_destroy(w);
    scene_destroy(s);
    return made;
}

#define PICTURE(name, file) "<texture type='bitmap' name='" name "'><string name='filename' value='" file "'/></texture>"
#define COLOUR(name, rgb) "<rgb name='" name "' value='" rgb "'/>"
#define PRODUCT(name, a, rgb) "<texture type='product' name='" name "'>" a COLOUR("texture_1", rgb) "</texture>"
#define BOARD(name, a, b) "<texture type='checkerboard' name='" name "'>" COLOUR("color0", a) COLOUR("color1", b) "</texture>"
#define ATTRIBUTE(name, more) "<texture type='mesh_attribute' name='" name "'><string name='name' value='vertex_color'/>" more "</texture>"
#define DIFFUSE(texture) "<bsdf type='diffuse'>" texture "</bsdf>"
#define SPHERE(bsdf) "<shape type='sphere'>" bsdf "</shape>"
#define MESH(file, bsdf) "<shape type='ply'><string name='filename' value='" file "'/>" bsdf "</shape>"

// Bodies, and the words of the one warning; NULL: none.
static const struct {
    const char *body, *words;
} cases[] = {
    {SPHERE(DIFFUSE(PICTURE("reflectance", "high.exr"))),
     "scene.xml:2: diffuse: \"reflectance\" is the bitmap of line 2 with values from 0.25 to 37.5, expected 0 to 1: "
     "more light leaves than comes"},
    {SPHERE(DIFFUSE(PICTURE("reflectance", "low.exr"))), "with values from -0.5 to 0.25, expected 0 to 1\n"},
    {SPHERE(DIFFUSE(PICTURE("reflectance", "good.exr"))), NULL},
    {SPHERE(DIFFUSE(BOARD("reflectance", "0.2, 0.3, 2", "1"))), "is the checkerboard of line 2 with values from 0.2 to 2"},
    {SPHERE(DIFFUSE(PRODUCT("reflectance", PICTURE("texture_0", "high.exr"), "1, 0.01, 1"))), NULL},
    {SPHERE(DIFFUSE(PRODUCT("reflectance", PICTURE("texture_0", "high.exr"), "1, 0.04, 1"))), "to 1.5,"},
    {SPHERE("<bsdf type='conductor'>" BOARD("specular_reflectance", "1", "1.5") "</bsdf>"), "\"specular_reflectance\" is"},
    {SPHERE("<bsdf type='blendbsdf'>" BOARD("weight", "0", "4") DIFFUSE("") DIFFUSE("") "</bsdf>"),
     "blendbsdf: \"weight\" is the checkerboard of line 2 with values from 0 to 4, expected 0 to 1\n"},
    {SPHERE("<bsdf type='blendbsdf'>" DIFFUSE(BOARD("reflectance", "1", "4")) DIFFUSE("") "</bsdf>"), "diffuse: \"reflectance\""},
    {"<bsdf type='diffuse' id='unworn'>" BOARD("reflectance", "1", "4") "</bsdf>" SPHERE(""), NULL},
    {"<texture type='checkerboard' id='t'><rgb name='color0' value='9'/></texture>\n"
     SPHERE(DIFFUSE("<ref id='t' name='reflectance'/>")) "\n" SPHERE(DIFFUSE("<ref id='t' name='reflectance'/>")),
     "scene.xml:3: diffuse: \"reflectance\" is the checkerboard of line 2"},
    {SPHERE("<emitter type='area'>" BOARD("radiance", "1", "4") "</emitter>"), NULL},
    {MESH("bare.ply", DIFFUSE(ATTRIBUTE("reflectance", ""))), "is the mesh_attribute of line 2 with values from 0 to 3"},
    {MESH("bare.ply", DIFFUSE(ATTRIBUTE("reflectance", "<float name='scale' value='0.25'/>"))), NULL},
    {SPHERE(DIFFUSE(PICTURE("reflectance", "odd.exr"))) SPHERE(DIFFUSE(PICTURE("reflectance", "odd.exr"))),
     "odd.exr has 2 texels that are not finite; they count as zero"},
    {MESH("mapped.ply", DIFFUSE(PICTURE("reflectance", "good.exr"))), NULL},
    {MESH("bare.ply", DIFFUSE(PICTURE("reflectance", "good.exr"))),
     "scene.xml:2: bitmap: the mesh of the shape \"ply\" of line 2 has no texture coordinates"},
    {MESH("bare.ply", DIFFUSE(PRODUCT("reflectance", BOARD("texture_0", "1", "0"), "1"))), "checkerboard: the mesh of"},
    {MESH("mapped.ply", DIFFUSE("<texture type='uvmap' name='reflectance'>" PICTURE("texture", "good.exr") "</texture>")),
     "uvmap: the shape \"ply\" of line 2 has no attribute \"vertex_uv1\" and keeps its own coordinates; it has vertex_color"},
    {MESH("bare.ply", DIFFUSE("<texture type='uvmap' name='reflectance'><string name='attribute' value='vertex_color'/>"
                              PICTURE("texture", "good.exr") "</texture>")), NULL},
};

static void says_what_is_odd_once(void) {
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        CHECK(make(cases[i].body));
        const bool told = cases[i].words ? count("warning: ") == 1 && captured_has(cases[i].words) : !*captured;
        CHECK(told);
        if (!told)
            printf("case %zu, expected %s, got: %s\n", i, cases[i].words, captured);
    }
}

static void an_attribute_that_is_lacking_is_an_error(void) {
    CHECK(!make(MESH("bare.ply", DIFFUSE("<texture type='mesh_attribute' name='reflectance'>"
                                         "<string name='name' value='vertex_colr'/></texture>"))));
    CHECK(captured_has("has no attribute \"vertex_colr\"; did you mean \"vertex_color\"?"));
}

int main(void) {
    scene_folder_open();
    write_meshes();
    write_picture("good.exr", 0.5f, 1);
    write_picture("high.exr", 37.5f, 1);
    write_picture("low.exr", -0.5f, 0.125f);
    write_picture("odd.exr", NAN, INFINITY);
    says_what_is_odd_once();
    an_attribute_that_is_lacking_is_an_error();
    scene_folder_close();
    return check_result();
}
