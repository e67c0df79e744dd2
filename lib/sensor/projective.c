// SPDX-License-Identifier: Apache-2.0
#include "sensor/projective.h"

#include <stdlib.h>
#include <string.h>

enum axis { AXIS_X, AXIS_Y, AXIS_DIAGONAL, AXIS_SMALLER, AXIS_LARGER };

const char *const fov_axes[] = {"x", "y", "diagonal", "smaller", "larger", NULL};

// "50mm" or "50" in millimetres; 0 when it is neither.
static double parse_focal_length(const char *text) {
    char *end;
    const double mm = strtod(text, &end);
    const bool unit = *end == '\0' || strcmp(end, "mm") == 0;
    return end != text && unit && mm > 0 && mm < 1e9 ? mm : 0;
}

// Half the extent along `axis` at distance 1 to half the width.
static double half_width(double half, enum axis axis, double aspect) {
    if (axis == AXIS_SMALLER)
        axis = aspect > 1 ? AXIS_Y : AXIS_X;
    if (axis == AXIS_LARGER)
        axis = aspect > 1 ? AXIS_X : AXIS_Y;
    if (axis == AXIS_Y)
        return half * aspect;
    if (axis == AXIS_DIAGONAL)
        return half / sqrt(1 + 1 / (aspect * aspect));
    return half;
}

double field_of_view_half_width(const struct object *self, const struct field_of_view *view,
                                double aspect) {
    if (view->fov > 0 && view->focal_length) {
        log_error_at(self->at, "%s: fov and focal_length are both given, expected one of them",
                     self->type->name);
        return 0;
    }
    if (view->fov > 0)
        return half_width(tan(0.5 * view->fov * (M_PI / 180)), (enum axis)view->axis, aspect);
    const char *text = view->focal_length ? view->focal_length : "50mm";
    const double mm = parse_focal_length(text);
    if (!(mm > 0)) {
        log_error_at(self->at, "%s: focal_length is '%s', expected a length like '50mm'",
                     self->type->name, text);
        return 0;
    }
    // The film's diagonal, 36 mm x 24 mm, spans the picture's diagonal.
    return half_width(0.5 * sqrt(36 * 36 + 24 * 24) / mm, AXIS_DIAGONAL, aspect);
}

bool projective_prepare(const struct object *self, const struct projective *p,
                        const double centre[3], struct transform *out) {
    struct transform inverse;
    if (!(p->near_clip < p->far_clip)) {
        log_error_at(self->at, "%s: near_clip %g, expected less than far_clip %g",
                     self->type->name, p->near_clip, p->far_clip);
        return false;
    }
    *out = p->to_world;
    for (int i = 0; i < 3; i++)
        out->m[i][3] -= centre[i];
    if (!sensor_reaches(self, (const double[3]){out->m[0][3], out->m[1][3], out->m[2][3]}))
        return false;
    if (!transform_is_finite(out) || !transform_invert(out, &inverse)) {
        log_error_at(self->at, "%s: to_world is singular, expected an invertible transform",
                     self->type->name);
        return false;
    }
    return true;
}

static vec3 to_vec3(const double a[3]) {
    return v3((float)a[0], (float)a[1], (float)a[2]);
}

struct film_plane film_plane_make(const struct transform *to_world, int width, int height,
                                  double half, double z, const double offset[2], bool points) {
    const double pixel = 2 * half / width; // pixels are square
    const double middle[3] = {-2 * half * offset[0], -pixel * height * offset[1], z};
    const double dx[3] = {-pixel, 0, 0}, dy[3] = {0, -pixel, 0};
    double m[3], x[3], y[3];
    if (points)
        transform_point(to_world, middle, m);
    else
        transform_vector(to_world, middle, m);
    transform_vector(to_world, dx, x);
    transform_vector(to_world, dy, y);
    return (struct film_plane){to_vec3(m), to_vec3(x), to_vec3(y), 0.5f * (float)width,
                               0.5f * (float)height};
}
