// SPDX-License-Identifier: Apache-2.0
#include "filter/cubic.h"
#include "filter/filter.h"

struct mitchell {
    float b, c;
};

static const struct param params[] = {
    {"B", PARAM_FLOAT, offsetof(struct mitchell, b), .def = "0.3333333333", .min = -1, .max = 2,
     .unit = "", .help = "blur"},
    {"C", PARAM_FLOAT, offsetof(struct mitchell, c), .def = "0.3333333333", .min = -1, .max = 2,
     .unit = "", .help = "ringing"},
    PARAM_END,
};

static bool prepare(struct object *self, float *radius) {
    (void)self;
    *radius = 2;
    return true;
}

static float eval(const void *data, float x) {
    const struct mitchell *m = data;
    return cubic_spline(x, m->b, m->c);
}

const struct filter_type filter_mitchell = {
    .entry = {.name = "mitchell", .help = "cubic spline (Mitchell, Netravali 1988)",
              .params = params, .size = sizeof(struct mitchell)},
    .prepare = prepare, .eval = eval,
};
