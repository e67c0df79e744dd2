// SPDX-License-Identifier: Apache-2.0
// 1 where a texture reaches a threshold, 0 elsewhere: cut-out shapes.
#include "texture/texture.h"

struct step {
    struct texture_ref value;
    float threshold;
};

static const struct param params[] = {
    {"value", PARAM_TEXTURE_SCALAR, offsetof(struct step, value), .unit = "",
     .help = "what is compared"},
    {"threshold", PARAM_FLOAT, offsetof(struct step, threshold), .def = "0.5", .unit = "",
     .help = "least value that gives 1"},
    PARAM_END,
};

static spectrum eval(const void *data, const struct texture_point *at) {
    const struct step *self = data;
    return spectrum_grey(texture_eval_scalar(&self->value, at) >= self->threshold);
}

// Of the mean, since what the texture does in between is not known here.
static spectrum mean(const void *data) {
    const struct step *self = data;
    return spectrum_grey(spectrum_luminance(texture_mean(&self->value)) >= self->threshold);
}

static struct texture_range range(const void *data, const struct mesh *mesh) {
    (void)data;
    (void)mesh;
    return (struct texture_range){spectrum_grey(0), spectrum_grey(1)};
}

static void size(const void *data, int *width, int *height) {
    const struct step *self = data;
    *width = *height = 1;
    if (self->value.texture)
        texture_size(self->value.texture, width, height);
}

const struct texture_type texture_step = {
    .entry = {.name = "step", .help = "1 where a texture reaches a threshold", .params = params,
              .size = sizeof(struct step)},
    .eval = eval, .mean = mean, .range = range, .size = size,
};
