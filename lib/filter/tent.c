// SPDX-License-Identifier: Apache-2.0
#include "filter/filter.h"

struct tent {
    float radius;
};

static const struct param params[] = {
    {"radius", PARAM_FLOAT, offsetof(struct tent, radius), .def = "1", .min = 1e-3, .max = 64,
     .unit = "pixels", .help = "half the width of the foot"},
    PARAM_END,
};

static const char *const aliases[] = {"triangle", NULL};

static bool prepare(struct object *self, float *radius) {
    *radius = ((const struct tent *)self->data)->radius;
    return true;
}

static float eval(const void *data, float x) {
    return maxf(1 - fabsf(x) / ((const struct tent *)data)->radius, 0);
}

const struct filter_type filter_tent = {
    .entry = {.name = "tent", .help = "falls linearly to zero", .aliases = aliases,
              .params = params, .size = sizeof(struct tent)},
    .prepare = prepare, .eval = eval,
};
