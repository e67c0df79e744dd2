// SPDX-License-Identifier: Apache-2.0
// Directives of pbrt that change the current transform.
#include <string.h>

#include "scene/pbrt.h"

static bool apply(struct pbrt *p, const struct transform *t) {
    p->state.ctm = transform_multiply(&p->state.ctm, t);
    return true;
}

static bool do_identity(struct pbrt *p, struct where at) {
    (void)at;
    p->state.ctm = transform_identity;
    return true;
}

static bool do_translate(struct pbrt *p, struct where at) {
    double v[3];
    (void)at;
    if (!pbrt_read_numbers(p, "Translate", 3, v))
        return false;
    const struct transform t = transform_translate(v[0], v[1], v[2]);
    return apply(p, &t);
}

static bool do_scale(struct pbrt *p, struct where at) {
    double v[3];
    (void)at;
    if (!pbrt_read_numbers(p, "Scale", 3, v))
        return false;
    const struct transform t = transform_scale(v[0], v[1], v[2]);
    return apply(p, &t);
}

static bool do_rotate(struct pbrt *p, struct where at) {
    double v[4];
    if (!pbrt_read_numbers(p, "Rotate", 4, v))
        return false;
    if (!(v[1] * v[1] + v[2] * v[2] + v[3] * v[3] > 0)) {
        log_error_at(at, "Rotate: the axis has no length");
        return false;
    }
    const struct transform t = transform_rotate(v + 1, v[0]);
    return apply(p, &t);
}

// World to camera: the inverse of ours, whose axes are the same; pbrt shows x to the right.
static bool do_look_at(struct pbrt *p, struct where at) {
    double v[9];
    struct transform look, inverse;
    if (!pbrt_read_numbers(p, "LookAt", 9, v))
        return false;
    if (!transform_look_at(v, v + 3, v + 6, &look) || !transform_invert(&look, &inverse)) {
        log_error_at(at, "LookAt: the points coincide, or up is along the view");
        return false;
    }
    return apply(p, &inverse);
}

// Sixteen numbers, by columns.
static bool read_matrix(struct pbrt *p, struct where at, const char *what, struct transform *t) {
    double v[16];
    if (!pbrt_read_numbers(p, what, 16, v))
        return false;
    for (int i = 0; i < 16; i++)
        t->m[i % 4][i / 4] = v[i];
    if (transform_make_affine(t))
        return true;
    log_error_at(at, "%s: the last row is %g %g %g %g, expected 0 0 0 1: no projection", what, v[3],
                 v[7], v[11], v[15]);
    return false;
}

static bool do_transform(struct pbrt *p, struct where at) {
    return read_matrix(p, at, "Transform", &p->state.ctm);
}

static bool do_concat(struct pbrt *p, struct where at) {
    struct transform t;
    return read_matrix(p, at, "ConcatTransform", &t) && apply(p, &t);
}

static bool do_system(struct pbrt *p, struct where at) {
    const char *name = pbrt_read_string(p, "the name of a coordinate system in quotes");
    (void)at;
    if (name)
        *LIST_ADD(&p->systems, struct pbrt_system) = (struct pbrt_system){name, p->state.ctm};
    return name != NULL;
}

static bool do_use_system(struct pbrt *p, struct where at) {
    const char *name = pbrt_read_string(p, "the name of a coordinate system in quotes");
    for (size_t i = p->systems.count; name && i-- > 0;)
        if (strcmp(LIST_AT(&p->systems, struct pbrt_system, i).name, name) == 0) {
            p->state.ctm = LIST_AT(&p->systems, struct pbrt_system, i).ctm;
            return true;
        }
    if (name && strcmp(name, "camera") == 0) {
        p->state.ctm = p->camera;
        return transform_invert(&p->camera, &p->state.ctm);
    }
    if (name)
        log_error_at(at, "there is no coordinate system \"%s\" before this line", name);
    return false;
}

static bool do_reverse(struct pbrt *p, struct where at) {
    (void)at;
    p->state.reversed = !p->state.reversed;
    return true;
}

static bool do_active(struct pbrt *p, struct where at) {
    struct pbrt_token t;
    if (!pbrt_next(p, &t))
        return false;
    if (!pbrt_token_is(&t, "All"))
        pbrt_warn(p, at, "nothing moves here: transforms of any time are applied");
    return true;
}

static bool do_times(struct pbrt *p, struct where at) {
    double v[2];
    (void)at;
    return pbrt_read_numbers(p, "TransformTimes", 2, v);
}

const struct pbrt_directive pbrt_transforms[] = {
    {"Identity", do_identity},
    {"Translate", do_translate},
    {"Scale", do_scale},
    {"Rotate", do_rotate},
    {"LookAt", do_look_at},
    {"Transform", do_transform},
    {"ConcatTransform", do_concat},
    {"CoordinateSystem", do_system},
    {"CoordSysTransform", do_use_system},
    {"ReverseOrientation", do_reverse},
    {"ActiveTransform", do_active},
    {"TransformTimes", do_times},
    {0},
};
