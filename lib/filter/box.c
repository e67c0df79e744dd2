// SPDX-License-Identifier: Apache-2.0
// Every sample of the pixel counts alike, and none of its neighbours'.
#include "filter/filter.h"

struct box {
    float radius;
};

static const struct param params[] = {
    {"radius", PARAM_FLOAT, offsetof(struct box, radius), .def = "0.5", .min = 1e-3, .max = 64,
     .unit = "pixels", .help = "half the width"},
    PARAM_END,
};

static bool prepare(struct object *self, float *radius) {
    *radius = ((const struct box *)self->data)->radius;
    return true;
}

static float eval(const void *data, float x) {
    return fabsf(x) <= ((const struct box *)data)->radius ? 1 : 0;
}

const struct filter_type filter_box = {
    .entry = {.name = "box", .help = "constant over the pixel", .params = params,
              .size = sizeof(struct box)},
    .prepare = prepare, .eval = eval,
};
