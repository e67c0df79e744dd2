// SPDX-License-Identifier: Apache-2.0
// What the projecting cameras share: field of view, clipping and the film in world space.
//
// Camera space as in Mitsuba: the camera looks along +z, y is up and x points to the LEFT of the
// picture, so film x runs against camera x.
#pragma once

#include "sensor/sensor.h"

struct projective {
    struct transform to_world;
    float near_clip, far_clip; // distances along +z of camera space
};

struct field_of_view {
    float fov;                // degrees; 0: not given
    int axis;                 // index into fov_axes
    const char *focal_length; // "50mm" on 36 x 24 mm film; NULL: not given
};

extern const char *const fov_axes[];

// Table entries of the parameters above, for members `projective` and `view` of a struct.
#define PROJECTIVE_PARAMS(type)                                                                    \
    {"to_world", PARAM_TRANSFORM, offsetof(struct type, projective.to_world), .def = "",           \
     .unit = "", .help = "camera to world; looks along +z, y up"},                                 \
    {"near_clip", PARAM_FLOAT, offsetof(struct type, projective.near_clip), .def = "1e-2",         \
     .min = 1e-30, .max = 1e30, .unit = "m", .help = "nothing nearer along the view is seen"},     \
    {"far_clip", PARAM_FLOAT, offsetof(struct type, projective.far_clip), .def = "1e4",            \
     .min = 1e-30, .max = 1e30, .unit = "m", .help = "no surface farther along the view is seen"}, \
    {"shutter_open", PARAM_IGNORED, .unit = "", .help = "nothing moves here"},                     \
    {"shutter_close", PARAM_IGNORED, .unit = "", .help = "nothing moves here"}

#define FIELD_OF_VIEW_PARAMS(type)                                                                 \
    {"fov", PARAM_FLOAT, offsetof(struct type, view.fov), .min = 1e-4, .max = 179.9999,            \
     .unit = "degrees", .help = "field of view along fov_axis", .optional = true},                 \
    {"fov_axis", PARAM_CHOICE, offsetof(struct type, view.axis), .def = "x", .unit = "",           \
     .help = "which extent of the picture fov spans", .choices = fov_axes},                        \
    {"focal_length", PARAM_STRING, offsetof(struct type, view.focal_length), .unit = "mm",         \
     .help = "35 mm film equivalent, instead of fov; without both: 50mm", .optional = true}

// Half the picture's width at distance 1, or 0 after an error message.
double field_of_view_half_width(const struct object *self, const struct field_of_view *view,
                                double aspect);

// Checks clipping and transform; *out takes the camera to recentred world space. false after an
// error message.
bool projective_prepare(const struct object *self, const struct projective *p,
                        const double centre[3], struct transform *out);

// A plane of film in some space: point(x, y) = middle + (x - x0) dx + (y - y0) dy. Counting from
// the middle keeps the rounding error small where the picture is looked at most.
struct film_plane {
    vec3 middle, dx, dy;
    float x0, y0;
};

// half: half the width in camera space, at camera z; offset: of the picture's middle, in
// picture widths and heights. Points: with the translation; else directions.
struct film_plane film_plane_make(const struct transform *to_world, int width, int height,
                                  double half, double z, const double offset[2], bool points);

static inline vec3 film_plane_at(const struct film_plane *f, float x, float y) {
    return f->middle + (x - f->x0) * f->dx + (y - f->y0) * f->dy;
}
