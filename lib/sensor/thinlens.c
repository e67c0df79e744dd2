// SPDX-License-Identifier: Apache-2.0
// Camera with a thin lens: only what lies at the focus distance is sharp.
#include "math/warp.h"
#include "sensor/projective.h"

struct thinlens {
    struct projective projective;
    struct field_of_view view;
    float aperture_radius, focus_distance;
    // made by prepare
    struct film_plane film; // directions with z = 1 in camera space
    vec3 origin;
    vec3 lens_x, lens_y; // radii of the aperture
    float focus;
};

static const struct param params[] = {
    PROJECTIVE_PARAMS(thinlens),
    FIELD_OF_VIEW_PARAMS(thinlens),
    {"aperture_radius", PARAM_FLOAT, offsetof(struct thinlens, aperture_radius), .min = 0,
     .max = 1e18, .unit = "m", .help = "radius of the lens; 0 is a pinhole"},
    {"focus_distance", PARAM_FLOAT, offsetof(struct thinlens, focus_distance), .min = 1e-30,
     .max = 1e30, .unit = "m", .help = "from lens to the sharp plane; not given: far_clip",
     .optional = true},
    PARAM_END,
};

static bool prepare(struct object *self, const struct sensor_scene *scene) {
    struct thinlens *t = self->data;
    const double aspect = (double)scene->width / scene->height;
    const double half = field_of_view_half_width(self, &t->view, aspect);
    struct transform m;
    if (!(half > 0) || !projective_prepare(self, &t->projective, scene->centre, &m))
        return false;
    const struct affine a = affine_from(&m);
    const double no_offset[2] = {0, 0};
    t->film = film_plane_make(&m, scene->width, scene->height, half, 1, no_offset, false);
    t->origin = a.o;
    t->lens_x = a.x * t->aperture_radius;
    t->lens_y = a.y * t->aperture_radius;
    t->focus = t->focus_distance > 0 ? t->focus_distance : t->projective.far_clip;
    return true;
}

static void ray(const void *data, float x, float y, struct vec2 u, struct ray *out) {
    const struct thinlens *t = data;
    const struct vec2 d = warp_disk(u);
    const vec3 on_lens = d.x * t->lens_x + d.y * t->lens_y;
    // Divided by the focus distance, so that camera z is 1 as the clip distances count it.
    const vec3 v = film_plane_at(&t->film, x, y) - on_lens * (1 / t->focus);
    const float l = length(v);
    *out = (struct ray){t->origin + on_lens, v * (1 / l), t->projective.near_clip * l,
                        t->projective.far_clip * l};
}

const struct sensor_type sensor_thinlens = {
    .entry = {.name = "thinlens", .help = "camera with depth of field (Kolb 1995)",
              .params = params, .size = sizeof(struct thinlens)},
    .prepare = prepare, .ray = ray, .lens = true,
};
