// SPDX-License-Identifier: Apache-2.0
// A shape that emits the same radiance in all directions on the side of its normal.
#include "light/area_picture.h"

#include <float.h>

#include "light/solid_angle.h"

struct area {
    struct texture_ref radiance;
    // made by prepare
    bool is_mesh;
    struct area_mesh mesh;
    struct area_quadric quadric;
    struct area_picture picture; // of a textured rectangle
};

static const struct param params[] = {
    {"radiance", PARAM_TEXTURE_EMISSION, offsetof(struct area, radiance), .def = "1", .min = 0,
     .max = 1e30, .unit = "W/(sr m^2)", .help = "emitted radiance"},
    LIGHT_PARAMS,
    PARAM_END,
};

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    struct area *a = self->data;
    (void)arena;
    if (!scene->shape) {
        log_error_at(self->at, "area: an area light stands alone, expected it inside a shape");
        return false;
    }
    a->is_mesh = scene->shape->kind == SHAPE_MESH;
    const bool ok = a->is_mesh ? area_mesh_init(&a->mesh, scene->shape)
                               : area_quadric_init(&a->quadric, scene->shape);
    if (ok && a->is_mesh)
        area_picture_init(&a->picture, &a->radiance, &a->mesh);
    if (!ok)
        log_error_at(self->at, "area: the shape '%s' has no area, expected one that can emit",
                     scene->shape->name);
    return ok;
}

// ---- textured rectangles

// Share of the samples taken by the picture: all, but half where the light is so near that
// distance and foreshortening vary as much.
static float picture_share(const struct area *a, vec3 p) {
    return solid_angle_pays(&a->mesh, p) ? 0.5f : 1;
}

// The density of both ways together.
static float picture_pdf_sa(const struct area *a, vec3 p, const struct light_hit *hit) {
    const float share = picture_share(a, p);
    const float density = area_picture_density(&a->picture, area_mesh_xy(&a->mesh, &hit->at));
    const float pdf = area_to_solid_angle(density * a->mesh.inv_area, hit->distance,
                                          fabsf(dot(hit->ng, hit->wi)));
    return share < 1 ? share * pdf + (1 - share) * area_mesh_pdf_sa(&a->mesh, p, hit) : pdf;
}

static bool picture_sample(const struct area *a, vec3 p, struct vec2 u, struct light_sample *s) {
    const float share = picture_share(a, p);
    struct texture_point at = {0};
    if (u.x < share) {
        float density;
        u.x = minf(u.x / share, 0x1.fffffep-1f);
        *s = (struct light_sample){0};
        area_mesh_place_at(&a->mesh, area_picture_sample(&a->picture, u, &density), s, &at);
        if (!area_finish_sample(p, a->mesh.inv_area, s))
            return false;
    } else {
        u.x = minf((u.x - share) / (1 - share), 0x1.fffffep-1f);
        if (!area_mesh_sample(&a->mesh, p, u, s, &at))
            return false;
    }
    const struct light_hit hit = {s->wi, s->distance, s->n, at};
    s->pdf_sa = picture_pdf_sa(a, p, &hit);
    s->delta = false;
    s->emission = texture_eval(&a->radiance, &at);
    return s->pdf_sa > 0;
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    const struct area *a = data;
    if (a->picture.size)
        return picture_sample(a, p, u, s);
    struct texture_point at = {0}, *want = a->radiance.texture ? &at : NULL;
    const bool ok = a->is_mesh ? area_mesh_sample(&a->mesh, p, u, s, want)
                               : area_quadric_sample(&a->quadric, p, u, s, want);
    if (!ok)
        return false;
    s->delta = false;
    s->emission = texture_eval(&a->radiance, &at);
    return true;
}

static bool has_wide(const void *data) {
    const struct area *a = data;
    return !a->radiance.texture && (a->is_mesh ? a->mesh.kind == POLYGON_RECTANGLE
                                               : area_quadric_is_wide(&a->quadric));
}

static wide_mask sample_wide(const void *data, const struct wide3 *p, const wide u[2],
                             struct light_samples *s) {
    const struct area *a = data;
    s->emission = wide3_of(a->radiance.value);
    return a->is_mesh ? area_rectangle_sample_wide(&a->mesh, p, u, s)
                      : area_sphere_sample_wide(&a->quadric, p, u, s);
}

static spectrum emission(const void *data, const struct light_hit *hit) {
    const struct area *a = data;
    const bool faces = a->is_mesh ? area_mesh_faces(&a->mesh, hit) : dot(hit->ng, hit->wi) < 0;
    return faces ? texture_eval(&a->radiance, &hit->at) : spectrum_grey(0);
}

static float pdf_sa(const void *data, vec3 p, const struct light_hit *hit) {
    const struct area *a = data;
    if (a->picture.size)
        return picture_pdf_sa(a, p, hit);
    return a->is_mesh ? area_mesh_pdf_sa(&a->mesh, p, hit)
                      : area_quadric_pdf_sa(&a->quadric, p, hit);
}

static float power(const void *data) {
    const struct area *a = data;
    const float area = a->is_mesh ? a->mesh.area : a->quadric.area;
    return PI * area * spectrum_luminance(texture_mean(&a->radiance));
}

// ---- for the light tree

static uint32_t parts(const void *data) {
    const struct area *a = data;
    return a->is_mesh ? area_mesh_parts(&a->mesh) : 1;
}

static void part_shape(const void *data, uint32_t part, struct light_leaf *leaf) {
    area_mesh_part_shape(&((const struct area *)data)->mesh, part, leaf);
}

static bool part_sample(const void *data, uint32_t part, const struct light_leaf *leaf, vec3 p,
                        struct vec2 u, struct light_sample *s) {
    const struct area *a = data;
    struct texture_point at = {0};
    if (!area_mesh_part_sample(&a->mesh, part, leaf, p, u, s, a->radiance.texture ? &at : NULL))
        return false;
    s->delta = false;
    s->emission = texture_eval(&a->radiance, &at);
    return true;
}

static float part_pdf_sa(float inv_area, const struct light_hit *hit) {
    return area_to_solid_angle(inv_area, hit->distance, fabsf(dot(hit->ng, hit->wi)));
}

// Mean luminance of the radiance over a triangle, from a few places. What lies between them may be
// brighter: a share of the mean over the whole texture stays.
static float part_radiance(const struct area *a, uint32_t part) {
    enum { PLACES = 16 };
    const float whole = spectrum_luminance(texture_mean(&a->radiance));
    if (!a->radiance.texture || !a->is_mesh || area_mesh_parts(&a->mesh) == 1)
        return a->radiance.texture ? maxf(whole, 1e-3f) : whole;
    float sum = 0;
    for (int i = 0; i < PLACES; i++) {
        struct texture_point at;
        const float x = ((float)(i % 4) + 0.5f) / 4, y = ((float)(i / 4) + 0.5f) / 4;
        const float r = sqrtf(x);
        area_mesh_place(&a->mesh, part, (struct vec2){1 - r, r * y}, &at);
        sum += maxf(spectrum_luminance(texture_eval(&a->radiance, &at)), 0) / PLACES;
    }
    return maxf(sum, whole > 0 ? 0.05f * whole : 1e-3f);
}

static void bounds(const void *data, uint32_t part, struct light_bounds *b) {
    const struct area *a = data;
    if (a->is_mesh)
        area_mesh_bounds(&a->mesh, part, b);
    else
        area_quadric_bounds(&a->quadric, b);
    b->intensity = minf(b->intensity * part_radiance(a, part), FLT_MAX);
}

static void finish(void *data) {
    struct area *a = data;
    area_picture_finish(&a->picture);
    if (a->is_mesh)
        area_mesh_finish(&a->mesh);
}

const struct light_type light_area = {
    .entry = {.name = "area", .help = "emitting surface", .params = params,
              .size = sizeof(struct area)},
    .prepare = prepare, .sample = sample, .sample_wide = sample_wide, .has_wide = has_wide,
    .emission = emission, .pdf_sa = pdf_sa, .power = power,
    .bounds = bounds, .parts = parts, .part_shape = part_shape, .part_sample = part_sample,
    .part_pdf_sa = part_pdf_sa, .finish = finish,
};
