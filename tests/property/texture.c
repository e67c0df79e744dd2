// SPDX-License-Identifier: Apache-2.0
// Textures against brute force: pictures in every storage, wrap and filter mode, their means and
// gradients; the checkerboard; values of meshes.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "check.h"
#include "image/image.h"
#include "make_object.h"
#include "math/hash.h"
#include "texture/texture.h"

enum { WIDTH = 5, HEIGHT = 3 };

static char folder[] = "relume-texture-XXXXXX";

static const char *path_of(const char *name) {
    static char path[64];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

// A picture of random values that 8 bits (and half precision) hold exactly.
static void make_picture(struct image *im, int channels, uint64_t seed, float scale) {
    struct rng rng = {seed};
    CHECK(image_init(im, WIDTH, HEIGHT, channels));
    for (int i = 0; i < WIDTH * HEIGHT * channels; i++)
        im->pixels[i] = scale * (float)(int)(rng_float(&rng) * 256);
}

static int wrap_by_definition(const char *mode, int i, int n) {
    if (strcmp(mode, "repeat") == 0)
        return ((i % n) + n) % n;
    if (strcmp(mode, "clamp") == 0)
        return i < 0 ? 0 : i >= n ? n - 1 : i;
    if (strcmp(mode, "mirror") == 0) {
        while (i < 0 || i >= n)
            i = i < 0 ? -1 - i : 2 * n - 1 - i;
        return i;
    }
    return i >= 0 && i < n ? i : -1;
}

static double pixel(const struct image *im, const char *mode, int x, int y, int c) {
    const int i = wrap_by_definition(mode, x, im->width), j = wrap_by_definition(mode, y, im->height);
    if (i < 0 || j < 0)
        return strcmp(mode, "one") == 0;
    const int channel = im->channels == 1 ? 0 : c;
    return im->pixels[(j * im->width + i) * im->channels + channel];
}

static double lookup(const struct image *im, const char *mode, bool nearest, double u, double v,
                     int c) {
    if (nearest)
        return pixel(im, mode, (int)floor(u * im->width), (int)floor(v * im->height), c);
    const double x = u * im->width - 0.5, y = v * im->height - 0.5;
    const int i = (int)floor(x), j = (int)floor(y);
    const double a = x - i, b = y - j;
    return (1 - b) * ((1 - a) * pixel(im, mode, i, j, c) + a * pixel(im, mode, i + 1, j, c)) +
           b * ((1 - a) * pixel(im, mode, i, j + 1, c) + a * pixel(im, mode, i + 1, j + 1, c));
}

static struct texture_point at_uv(float u, float v) {
    return (struct texture_point){.uv = {u, v}};
}

static spectrum eval(const struct object *o, float u, float v) {
    const struct texture_point at = at_uv(u, v);
    return texture_type_of(o)->eval(o->data, &at);
}

static void finish(struct object *o) {
    if (texture_type_of(o)->finish)
        texture_type_of(o)->finish(o->data);
}

// Compares with `im`, which holds what the file means.
static void compare(struct arena *arena, const char *file, const struct image *im,
                    const char *mode, bool nearest, const char *more) {
    struct object *o = make_texture(
        arena, "bitmap",
        arena_printf(arena, "filename=%s wrap_mode=%s filter_type=%s %s", path_of(file), mode,
                     nearest ? "nearest" : "bilinear", more), NULL);
    struct rng rng = {7};
    const struct texture_range range = texture_type_of(o)->range(o->data, NULL);
    for (int k = 0; k < 3000; k++) {
        const float u = rng_float(&rng) * 8 - 4, v = rng_float(&rng) * 8 - 4;
        const spectrum t = eval(o, u, v);
        // nearest: not within rounding of an edge between pixels
        const double x = u * WIDTH, y = v * HEIGHT;
        if (nearest && (fabs(x - rint(x)) < 1e-4 || fabs(y - rint(y)) < 1e-4))
            continue;
        for (int c = 0; c < 3; c++) {
            CHECK_NEAR(t[c], lookup(im, mode, nearest, u, v, c), 2e-5);
            CHECK(t[c] >= range.least[c] - 1e-5f && t[c] <= range.most[c] + 1e-5f);
        }
        CHECK(t[3] == 0);
    }
    const float odd[] = {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 16777216, 0, 1};
    for (int i = 0; i < 64; i++)
        CHECK(spectrum_is_finite(eval(o, odd[i % 8], odd[i / 8])));
    finish(o);
}

static const char *const modes[] = {"repeat", "mirror", "clamp", "zero", "one"};

static void pictures_are_looked_up_as_defined(void) {
    struct arena arena = {0};
    for (int kind = 0; kind < 4; kind++) { // half grey, half colour, float colour, 8-bit colour
        struct image im = {0}, linear = {0};
        const char *const file = kind == 3 ? "p.png" : "p.exr";
        make_picture(&im, kind == 0 ? 1 : 3, (uint64_t)kind, kind == 2 ? 1 / 255.0f : 1 / 256.0f);
        const struct image_exr_options options = {.half = kind < 2};
        if (kind < 3) {
            CHECK(image_write_exr(path_of(file), &im, &options));
            CHECK(image_init(&linear, WIDTH, HEIGHT, im.channels));
            memcpy(linear.pixels, im.pixels, sizeof(float) * WIDTH * HEIGHT * (size_t)im.channels);
        } else { // what was written may be rounded: take what is read as the truth, linearised
            CHECK(image_write_png(path_of(file), &im));
            struct image encoded = {0};
            CHECK(image_read(path_of(file), &encoded) && image_to_rgb(&encoded, &linear));
            CHECK(encoded.srgb_encoded && encoded.bits == 8);
            image_finish(&encoded);
        }
        for (int m = 0; m < 5; m++)
            for (int nearest = 0; nearest < 2; nearest++)
                compare(&arena, file, &linear, modes[m], nearest, "");
        image_finish(&im);
        image_finish(&linear);
    }
    arena_finish(&arena);
}

static void raw_pictures_keep_their_numbers(void) {
    struct arena arena = {0};
    struct image im = {0}, encoded = {0};
    make_picture(&im, 3, 9, 1 / 256.0f);
    CHECK(image_write_png(path_of("raw.png"), &im));
    CHECK(image_read(path_of("raw.png"), &encoded));
    compare(&arena, "raw.png", &encoded, "repeat", false, "raw=true");
    compare(&arena, "raw.png", &encoded, "repeat", false, "gamma=1");
    image_finish(&im);
    image_finish(&encoded);
    arena_finish(&arena);
}

static void channels_can_be_chosen(void) {
    struct arena arena = {0};
    struct image im = {0}, green = {0};
    make_picture(&im, 3, 10, 1 / 256.0f);
    CHECK(image_write_exr(path_of("c.exr"), &im, NULL) && image_init(&green, WIDTH, HEIGHT, 1));
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        green.pixels[i] = im.pixels[3 * i + 1];
    compare(&arena, "c.exr", &green, "clamp", false, "channel=g");
    compare(&arena, "c.exr", &green, "clamp", false, "channel=G");
    image_finish(&im);
    image_finish(&green);
    arena_finish(&arena);
}

static void means_and_gradients_are_those_of_lookups(void) {
    struct arena arena = {0};
    struct image im = {0};
    make_picture(&im, 3, 11, 1 / 256.0f);
    CHECK(image_write_exr(path_of("m.exr"), &im, NULL));
    struct object *o = make_texture(
        &arena, "bitmap",
        arena_printf(&arena, "filename=%s uscale=2 vscale=3 uoffset=0.1", path_of("m.exr")), NULL);
    const spectrum mean = texture_type_of(o)->mean(o->data);
    double sum = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        sum += im.pixels[3 * i + 2];
    CHECK_NEAR(mean[2], sum / (WIDTH * HEIGHT), 1e-6);
    const struct texture_ref ref = {.texture = o};
    struct rng rng = {12};
    for (int k = 0; k < 1000; k++) {
        const float u = rng_float(&rng), v = rng_float(&rng);
        const double x = (2 * u + 0.1) * WIDTH - 0.5, y = 3 * v * HEIGHT - 0.5, h = 1e-3;
        if (fabs(x - rint(x)) < 0.05 || fabs(y - rint(y)) < 0.05)
            continue; // the gradient jumps at pixel centres
        const struct texture_point at = at_uv(u, v);
        const struct vec2 g = texture_gradient(&ref, &at);
        const float s = (float)h;
        const spectrum du = eval(o, u + s, v) - eval(o, u - s, v);
        const spectrum dv = eval(o, u, v + s) - eval(o, u, v - s);
        CHECK_NEAR(g.x, spectrum_luminance(du) / (2 * h), 2e-3);
        CHECK_NEAR(g.y, spectrum_luminance(dv) / (2 * h), 2e-3);
    }
    finish(o);
    image_finish(&im);
    arena_finish(&arena);
}

static void bad_pictures_are_refused(void) {
    struct arena arena = {0};
    struct object *o = make_object(&arena, &textures, "bitmap", "filename=nowhere.png", NULL);
    CHECK(!texture_bitmap.prepare(o, &arena));
    struct image im = {0};
    make_picture(&im, 3, 13, 1);
    CHECK(image_write_exr(path_of("n.exr"), &im, NULL));
    o = make_object(&arena, &textures, "bitmap",
                    arena_printf(&arena, "filename=%s channel=Q", path_of("n.exr")), NULL);
    CHECK(!texture_bitmap.prepare(o, &arena));
    image_finish(&im);
    arena_finish(&arena);
}

static void checkerboard_alternates(void) {
    struct arena arena = {0};
    struct object *o =
        make_texture(&arena, "checkerboard", "color0=0.9 color1=0.1,0.2,0.3 uscale=3", NULL);
    for (int i = -20; i < 20; i++) {
        for (int j = -20; j < 20; j++) {
            const float u = ((float)i + 0.5f) / 6, v = ((float)j + 0.5f) / 2;
            const spectrum t = eval(o, u, v);
            CHECK_NEAR(t[2], (i + j) % 2 == 0 ? 0.9 : 0.3, 1e-6);
        }
    }
    CHECK_NEAR(texture_type_of(o)->mean(o->data)[0], 0.5, 1e-6);
    arena_finish(&arena);
}

// Linear functions of position are reproduced by interpolation; faces are constant.
static void mesh_values_are_interpolated(void) {
    struct arena arena = {0};
    float positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    uint32_t indices[2][3] = {{0, 1, 2}, {0, 2, 3}};
    float at_vertex[12], at_face[2] = {0.25f, 0.75f};
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++)
            at_vertex[3 * i + c] = 0.1f + (float)(c + 1) * 0.2f * positions[i][0] +
                                   0.1f * positions[i][1];
    struct mesh_attribute attributes[2] = {{"vertex_color", 3, false, at_vertex},
                                           {"face_id", 1, true, at_face}};
    const struct mesh m = {.vertex_count = 4, .triangle_count = 2, .positions = positions,
                           .indices = indices, .attributes = attributes, .attribute_count = 2};
    const struct object *v = make_texture(&arena, "mesh_attribute", "name=vertex_color scale=2",
                                          NULL);
    const struct object *f = make_texture(&arena, "mesh_attribute", "name=face_id", NULL);
    const struct object *none = make_texture(&arena, "mesh_attribute", "name=face_other", NULL);
    struct rng rng = {14};
    for (int k = 0; k < 1000; k++) {
        float a = rng_float(&rng), b = rng_float(&rng) * (1 - a);
        struct texture_point at = {.mesh = &m, .triangle = (uint32_t)k % 2, .barycentric = {a, b}};
        const float *p1 = positions[indices[at.triangle][1]];
        const float *p2 = positions[indices[at.triangle][2]];
        const double x = a * p1[0] + b * p2[0], y = a * p1[1] + b * p2[1];
        const spectrum t = texture_mesh_attribute.eval(v->data, &at);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(t[c], 2 * (0.1 + (c + 1) * 0.2 * x + 0.1 * y), 1e-6);
        CHECK(texture_mesh_attribute.eval(f->data, &at)[1] == at_face[at.triangle]);
        CHECK(spectrum_is_black(texture_mesh_attribute.eval(none->data, &at)));
        at.mesh = NULL;
        CHECK(spectrum_is_black(texture_mesh_attribute.eval(v->data, &at)));
    }
    struct object *bad = make_object(&arena, &textures, "mesh_attribute", "name=color", NULL);
    CHECK(!texture_mesh_attribute.prepare(bad, &arena));
    arena_finish(&arena);
}

static void remove_folder(void) {
    static const char *const names[] = {"p.exr", "p.png", "raw.png", "c.exr", "m.exr", "n.exr"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        unlink(path_of(names[i]));
    rmdir(folder);
}

// A second set of coordinates that is (2 v + 0.3, u - v) everywhere.
static void other_coordinates_are_looked_up(void) {
    struct arena arena = {0};
    float positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    float uvs[4][2] = {{0.1f, 0.2f}, {0.9f, 0.1f}, {0.8f, 0.7f}, {0.2f, 0.9f}}, second[8];
    uint32_t indices[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (int i = 0; i < 4; i++) {
        second[2 * i] = 2 * uvs[i][1] + 0.3f;
        second[2 * i + 1] = uvs[i][0] - uvs[i][1];
    }
    struct mesh_attribute attribute = {"vertex_uv1", 2, false, second};
    const struct mesh mesh = {.vertex_count = 4, .triangle_count = 2, .positions = positions,
                              .uvs = uvs, .indices = indices, .attributes = &attribute,
                              .attribute_count = 1};
    struct image im = {0};
    make_picture(&im, 1, 14, 1 / 256.0f);
    CHECK(image_write_exr(path_of("u.exr"), &im, NULL));
    struct object *picture = make_texture(
        &arena, "bitmap", arena_printf(&arena, "filename=%s", path_of("u.exr")), NULL);
    const struct object *const children[] = {picture, NULL};
    struct object *o = make_texture(&arena, "uvmap", "", children);
    const struct texture_ref ref = {.texture = o}, direct = {.texture = picture};
    struct rng rng = {15};
    for (int k = 0; k < 1000; k++) {
        struct texture_point at = {.mesh = &mesh, .triangle = (uint32_t)k % 2};
        const float a = rng_float(&rng), b = rng_float(&rng) * (1 - a);
        at.barycentric = (struct vec2){a, b};
        const uint32_t *t = indices[at.triangle];
        for (int c = 0; c < 2; c++)
            (c ? &at.uv.y : &at.uv.x)[0] =
                (1 - a - b) * uvs[t[0]][c] + a * uvs[t[1]][c] + b * uvs[t[2]][c];
        const struct texture_point there = at_uv(2 * at.uv.y + 0.3f, at.uv.x - at.uv.y);
        CHECK_NEAR(texture_eval(&ref, &at)[0], texture_eval(&direct, &there)[0], 1e-5);
        const struct vec2 g = texture_gradient(&ref, &at), h = texture_gradient(&direct, &there);
        const float x = there.uv.x * WIDTH - 0.5f, y = there.uv.y * HEIGHT - 0.5f;
        if (fabsf(x - rintf(x)) < 1e-3f || fabsf(y - rintf(y)) < 1e-3f)
            continue; // the gradient jumps at pixel centres
        CHECK_NEAR(g.x, h.y, 1e-4);
        CHECK_NEAR(g.y, 2 * h.x - h.y, 1e-4);
    }
    const struct texture_point bare = at_uv(0.4f, 0.6f);
    CHECK(texture_eval(&ref, &bare)[0] == texture_eval(&direct, &bare)[0]);
    finish(picture);
    image_finish(&im);
    arena_finish(&arena);
}

int main(void) {
    if (!mkdtemp(folder))
        return 1;
    pictures_are_looked_up_as_defined();
    raw_pictures_keep_their_numbers();
    channels_can_be_chosen();
    means_and_gradients_are_those_of_lookups();
    bad_pictures_are_refused();
    checkerboard_alternates();
    mesh_values_are_interpolated();
    other_coordinates_are_looked_up();
    remove_folder();
    return check_result();
}
