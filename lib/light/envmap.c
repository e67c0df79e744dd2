// SPDX-License-Identifier: Apache-2.0
// Environment from a picture in latitude-longitude form, infinitely far away.
#include "image/image.h"
#include "light/light.h"
#include "light/sphere_table.h"
#include "math/wide_maps.h"

struct envmap {
    const char *filename;
    float scale;
    struct transform to_world;
    // made by prepare
    struct sphere_table table;
    struct affine world, local; // rotations
    float radius;               // of the scene
};

static const struct param params[] = {
    {"filename", PARAM_FILE, offsetof(struct envmap, filename), .unit = "",
     .help = "picture, twice as wide as high"},
    {"scale", PARAM_FLOAT, offsetof(struct envmap, scale), .def = "1", .min = 0, .max = 1e30,
     .unit = "", .help = "factor of the radiance in the file"},
    {"to_world", PARAM_TRANSFORM, offsetof(struct envmap, to_world), .def = "", .unit = "",
     .help = "rotates the picture, whose middle is at +z and top at +y"},
    {"mis_compensation", PARAM_IGNORED, .unit = "", .help = "sampling follows the luminance"},
    {"cache", PARAM_IGNORED, .unit = "", .help = "of version 0.5"},
    LIGHT_PARAMS,
    PARAM_END,
};

// Texels that no light can have become black. Their number.
static size_t repair(struct image *rgb) {
    const size_t count = (size_t)rgb->width * (size_t)rgb->height;
    size_t bad = 0;
    for (size_t i = 0; i < count; i++) {
        float *c = rgb->pixels + 3 * i;
        bool good = true;
        for (int k = 0; k < 3; k++) {
            const bool lane_good = c[k] >= 0 && c[k] < INFINITY;
            c[k] = lane_good ? minf(c[k], 1e30f) : 0;
            good = good && lane_good;
        }
        bad += !good;
    }
    return bad;
}

static bool read_picture(const struct object *self, struct envmap *e) {
    struct image picture, rgb;
    if (!image_read(e->filename, &picture))
        return false;
    const bool ok = image_to_rgb(&picture, &rgb);
    image_finish(&picture);
    if (!ok)
        return false;
    const size_t bad = repair(&rgb);
    if (bad)
        log_warn_at(self->at, "envmap: %s has %zu texels that are negative or not finite; "
                    "they count as zero", e->filename, bad);
    sphere_table_init(&e->table, rgb.pixels, rgb.width, rgb.height);
    image_finish(&rgb);
    return true;
}

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    struct envmap *e = self->data;
    (void)arena;
    e->radius = scene->radius;
    return light_rotation(self, &e->to_world, &e->world, &e->local) && read_picture(self, e);
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    const struct envmap *e = data;
    (void)p;
    vec3 w;
    *s = (struct light_sample){.distance = INFINITY};
    if (!sphere_table_sample(&e->table, u, &w, &s->pdf_sa, &s->emission))
        return false;
    s->wi = normalize(affine_vector(&e->world, w));
    s->emission *= e->scale;
    return true;
}

static void sample_groups(const void *data, int groups, const wide u[][2],
                          struct light_samples s[], wide_mask lit[]) {
    const struct envmap *e = data;
    const struct wide_frame world = {wide3_of(e->world.x), wide3_of(e->world.y),
                                     wide3_of(e->world.z)};
    struct sphere_patches at[LIGHT_GROUPS];
    if (!e->table.black)
        sphere_table_find_wide(&e->table, groups, u, at);
    for (int g = 0; g < groups; g++) {
        struct wide3 w, value;
        s[g].distance = wide_of(INFINITY);
        lit[g] = sphere_table_sample_wide(&e->table, &at[g], u[g], &w, &s[g].pdf_sa, &value);
        if (e->table.black)
            continue;
        s[g].wi = wide_normalize(wide_to_world(&world, w));
        s[g].emission = wide3_scale(wide_of(e->scale), value);
    }
}

static wide_mask sample_wide(const void *data, const struct wide3 *p, const wide u[2],
                             struct light_samples *s) {
    const wide group[1][2] = {{u[0], u[1]}};
    wide_mask lit;
    (void)p;
    *s = (struct light_samples){.distance = wide_of(INFINITY)};
    sample_groups(data, 1, group, s, &lit);
    return lit;
}

static spectrum emission(const void *data, const struct light_hit *hit) {
    const struct envmap *e = data;
    return e->scale * sphere_table_eval(&e->table, affine_vector(&e->local, hit->wi));
}

static float pdf_sa(const void *data, vec3 p, const struct light_hit *hit) {
    const struct envmap *e = data;
    (void)p;
    return sphere_table_pdf_sa(&e->table, affine_vector(&e->local, hit->wi));
}

static float power(const void *data) {
    const struct envmap *e = data;
    return light_power_infinite((float)e->table.mean * e->scale, e->radius);
}

static float detail(const void *data) {
    return PI / (float)(((const struct envmap *)data)->table.height);
}

static void finish(void *data) {
    sphere_table_finish(&((struct envmap *)data)->table);
}

const struct light_type light_envmap = {
    .entry = {.name = "envmap", .help = "environment from a latitude-longitude picture",
              .params = params, .size = sizeof(struct envmap)},
    .infinite = true,
    .prepare = prepare, .sample = sample, .sample_wide = sample_wide,
    .sample_groups = sample_groups, .emission = emission, .pdf_sa = pdf_sa, .power = power,
    .detail = detail, .finish = finish,
};
