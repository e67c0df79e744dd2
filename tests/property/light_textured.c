// SPDX-License-Identifier: Apache-2.0
// Area lights with every texture of the registry: where light comes from, and so where samples go,
// depends on the texture (light_check.h).
#include "property/light_check.h"

static struct object *textured[16];
static int textured_count;

static const struct object *keep_texture(struct object *texture) {
    textured[textured_count++] = texture;
    return texture;
}

static void add_attribute(struct mesh *m, const char *name, int channels, const float *values) {
    struct mesh_attribute *a = &m->attributes[m->attribute_count++];
    *a = (struct mesh_attribute){.channels = channels,
                                 .data = mem_array(m->vertex_count, (size_t)channels * sizeof(float))};
    snprintf(a->name, sizeof a->name, "%s", name);
    memcpy(a->data, values, m->vertex_count * (size_t)channels * sizeof(float));
}

// Colours at its corners, and a second set of coordinates that turns and stretches the first.
static struct shape *new_coloured_rectangle(void) {
    static const float colours[12] = {3, 0.1f, 0.2f, 0, 0.1f, 0, 0.1f, 0.5f, 0, 0.2f, 0.1f, 2};
    struct shape *s = new_rectangle(false);
    float uvs[8];
    for (int i = 0; i < 4; i++) {
        uvs[2 * i] = 2 * s->mesh.uvs[i][1] + 0.3f;
        uvs[2 * i + 1] = s->mesh.uvs[i][0] - s->mesh.uvs[i][1];
    }
    s->mesh.attributes = mem_array(2, sizeof *s->mesh.attributes);
    add_attribute(&s->mesh, "vertex_color", 3, colours);
    add_attribute(&s->mesh, "vertex_uv1", 2, uvs);
    return s;
}

static struct object *new_picture(int width, int height, const char *filter) {
    char path[64] = "/tmp/relume-picture-XXXXXX.exr", overrides[128];
    const int file = mkstemps(path, 4);
    struct image im;
    struct rng rng = {9};
    image_init(&im, width, height, 3);
    for (int i = 0; i < 3 * width * height; i++)
        im.pixels[i] = powf(rng_float(&rng), 4);
    CHECK(file >= 0 && image_write_exr(path, &im, &(struct image_exr_options){0}));
    close(file);
    image_finish(&im);
    snprintf(overrides, sizeof overrides, "filename=%s filter_type=%s", path, filter);
    struct object *o = make_texture(&arena, "bitmap", overrides, NULL);
    unlink(path);
    return o;
}

static struct object *new_light(const struct shape *s, const struct object *texture) {
    const struct object *const children[] = {texture, NULL};
    struct object *light = make_object(&arena, &lights, "area", "", children);
    const struct light_scene scene = {.radius = 1, .shape = s};
    CHECK(light_type_of(light)->prepare(light, &scene, &arena));
    return light;
}

// Near, where half of the samples go by solid angle, beside, far, and from behind.
static void add_textured_rectangle(const struct shape *s, const struct object *texture) {
    struct object *light = new_light(s, texture);
    const vec3 from[4] = {v3(0.3f, 0.2f, 0.4f), v3(-0.9f, 0.5f, 0.02f), v3(3, 1, 5), v3(0, 0, 300)};
    for (int i = 0; i < 4; i++) {
        struct light_case *c = add_case(texture->type->name, CHART_TRIANGLES, light, s, from[i]);
        c->kx = c->ky = 16;
        c->midpoints = 48;
        c->edges = true;
    }
    add_case(texture->type->name, CHART_TRIANGLES, light, s, v3(0, 0, -1))->may_be_empty = true;
}

// Samples go where they would without a texture; what they carry is looked up.
static void add_textured_quadrics(void) {
    const struct object *picture = keep_texture(new_picture(5, 7, "bilinear"));
    const struct transform place = transform_scale(0.5, 0.5, 0.5), odd = transform_scale(0.5, 0.9, 0.3);
    struct shape *const s[4] = {
        new_quadric(SHAPE_SPHERE, &place, false), new_quadric(SHAPE_SPHERE, &odd, false),
        new_quadric(SHAPE_DISK, &odd, false), new_quadric(SHAPE_CYLINDER, &odd, false)};
    const char *const names[4] = {"sphere", "ellipsoid", "disk", "cylinder"};
    for (int i = 0; i < 4; i++)
        add_case(names[i], i == 0 ? CHART_SPHERE_CAP : CHART_QUADRIC, new_light(s[i], picture), s[i],
                 v3(1, 0.8f, 1.2f))->midpoints = 48;
}

static void add_textured(void) {
    const struct shape *s = new_coloured_rectangle();
    const struct object *picture = keep_texture(new_picture(12, 40, "nearest"));
    const struct object *board =
        keep_texture(make_texture(&arena, "checkerboard", "color0=0.05 color1=3", NULL));
    const struct object *colours =
        keep_texture(make_texture(&arena, "mesh_attribute", "name=vertex_color", NULL));
    keep_texture(make_texture(&arena, "product", "", (const struct object *const[]){board, colours, NULL}));
    keep_texture(make_texture(&arena, "step", "threshold=0.1",
                              (const struct object *const[]){picture, NULL}));
    keep_texture(make_texture(&arena, "uvmap", "", (const struct object *const[]){board, NULL}));
    for (int i = 0; i < textured_count; i++)
        add_textured_rectangle(s, textured[i]);
    for (const struct entry *const *e = textures.entries; *e; e++) { // none is left out
        bool found = false;
        for (int i = 0; i < textured_count; i++)
            found = found || textured[i]->type == *e;
        CHECK(found);
    }
}

int main(void) {
    add_textured();
    add_textured_quadrics();
    check_cases();
    for (int i = 0; i < textured_count; i++)
        if (texture_type_of(textured[i])->finish)
            texture_type_of(textured[i])->finish(textured[i]->data);
    finish_cases();
    return check_result();
}
