// SPDX-License-Identifier: Apache-2.0
#include "filter/cubic.h"
#include "filter/filter.h"

static bool prepare(struct object *self, float *radius) {
    (void)self;
    *radius = 2;
    return true;
}

static float eval(const void *data, float x) {
    (void)data;
    return cubic_spline(x, 0, 0.5f);
}

const struct filter_type filter_catmullrom = {
    .entry = {.name = "catmullrom", .help = "interpolating cubic spline (Catmull, Rom 1974)",
              .size = sizeof(int)},
    .prepare = prepare, .eval = eval,
};
