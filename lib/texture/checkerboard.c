// SPDX-License-Identifier: Apache-2.0
// Checkerboard of 2 x 2 squares per unit of (u, v).
#include "texture/uv.h"

struct checkerboard {
    struct texture_ref color[2];
    struct uv_mapping uv;
};

static const struct param params[] = {
    {"color0", PARAM_TEXTURE, offsetof(struct checkerboard, color[0]), .def = "0.4", .unit = "",
     .help = "colour at the origin"},
    {"color1", PARAM_TEXTURE, offsetof(struct checkerboard, color[1]), .def = "0.2", .unit = "",
     .help = "the other colour"},
    UV_PARAMS(struct checkerboard, uv),
    PARAM_END,
};

static bool prepare(struct object *object, struct arena *arena) {
    struct checkerboard *self = object->data;
    (void)arena;
    uv_prepare(&self->uv);
    return true;
}

static spectrum eval(const void *data, const struct texture_point *at) {
    const struct checkerboard *self = data;
    const struct vec2 uv = uv_apply(&self->uv, at->uv);
    const bool u = uv.x - floorf(uv.x) > 0.5f, v = uv.y - floorf(uv.y) > 0.5f;
    return texture_eval(&self->color[u != v], at);
}

static struct vec2 gradient(const void *data, const struct texture_point *at) {
    (void)data;
    (void)at;
    return (struct vec2){0, 0};
}

static spectrum mean(const void *data) {
    const struct checkerboard *self = data;
    return 0.5f * (texture_mean(&self->color[0]) + texture_mean(&self->color[1]));
}

static struct texture_range range(const void *data, const struct mesh *mesh) {
    const struct checkerboard *self = data;
    struct texture_range both = texture_range(&self->color[0], mesh);
    const struct texture_range other = texture_range(&self->color[1], mesh);
    texture_range_add(&both, other.least);
    texture_range_add(&both, other.most);
    return both;
}

const struct texture_type texture_checkerboard = {
    .entry = {.name = "checkerboard", .help = "two colours in squares", .params = params,
              .size = sizeof(struct checkerboard)},
    .prepare = prepare, .eval = eval, .gradient = gradient, .mean = mean, .range = range,
    .reads_uv = true,
};
