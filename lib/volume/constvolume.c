// SPDX-License-Identifier: Apache-2.0
// The same value everywhere.
#include "volume/volume.h"

struct constvolume {
    spectrum value;
};

static const struct param params[] = {
    {"value", PARAM_INDEX, offsetof(struct constvolume, value), .def = "1", .min = 0, .max = 1e30,
     .unit = "", .help = "everywhere"},
    PARAM_END,
};

static spectrum eval(const void *data, vec3 p) {
    (void)p;
    return ((const struct constvolume *)data)->value;
}

static spectrum maximum(const void *data) {
    return ((const struct constvolume *)data)->value;
}

const struct volume_type volume_constvolume = {
    .entry = {.name = "constvolume", .help = "the same value everywhere", .params = params,
              .size = sizeof(struct constvolume)},
    .eval = eval, .maximum = maximum,
};
