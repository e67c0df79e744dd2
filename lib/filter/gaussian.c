// SPDX-License-Identifier: Apache-2.0
// Gaussian cut off at four standard deviations, lowered so that it ends at zero (as Mitsuba's).
#include "filter/filter.h"

struct gaussian {
    float stddev;
};

static const struct param params[] = {
    {"stddev", PARAM_FLOAT, offsetof(struct gaussian, stddev), .def = "0.5", .min = 1e-3,
     .max = 16, .unit = "pixels", .help = "standard deviation"},
    PARAM_END,
};

static bool prepare(struct object *self, float *radius) {
    *radius = 4 * ((const struct gaussian *)self->data)->stddev;
    return true;
}

static float eval(const void *data, float x) {
    const float t = x / ((const struct gaussian *)data)->stddev;
    const float edge = 3.3546262790251185e-4f; // exp(-8), the value at 4 standard deviations
    return maxf(expf(-0.5f * t * t) - edge, 0);
}

const struct filter_type filter_gaussian = {
    .entry = {.name = "gaussian", .help = "windowed Gaussian", .params = params,
              .size = sizeof(struct gaussian)},
    .prepare = prepare, .eval = eval,
};
