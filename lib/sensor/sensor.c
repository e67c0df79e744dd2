// SPDX-License-Identifier: Apache-2.0
#include "sensor/sensor.h"

static const struct entry *const entries[] = {
#define X(name) &sensor_##name.entry,
#include "sensor/list.h"
#undef X
    NULL,
};

const struct registry sensors = {"sensor", entries};
