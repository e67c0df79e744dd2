// SPDX-License-Identifier: Apache-2.0
// sinc windowed by the main lobe of a wider sinc.
#include "filter/filter.h"

struct lanczos {
    int lobes;
};

static const struct param params[] = {
    {"lobes", PARAM_INT, offsetof(struct lanczos, lobes), .def = "3", .min = 1, .max = 16,
     .unit = "", .help = "lobes on each side, and radius in pixels"},
    PARAM_END,
};

static bool prepare(struct object *self, float *radius) {
    *radius = (float)((const struct lanczos *)self->data)->lobes;
    return true;
}

static float sinc(float x) {
    return fabsf(x) < 1e-4f ? 1 - x * x / 6 : sinf(x) / x;
}

static float eval(const void *data, float x) {
    const float lobes = (float)((const struct lanczos *)data)->lobes;
    return fabsf(x) < lobes ? sinc(PI * x) * sinc(PI * x / lobes) : 0;
}

const struct filter_type filter_lanczos = {
    .entry = {.name = "lanczos", .help = "windowed sinc (Lanczos; Turkowski 1990)",
              .params = params, .size = sizeof(struct lanczos)},
    .prepare = prepare, .eval = eval,
};
