// SPDX-License-Identifier: Apache-2.0
#include "sensor/sensor.h"

#include "base/log.h"

static const struct entry *const entries[] = {
#define X(name) &sensor_##name.entry,
#include "sensor/list.h"
#undef X
    NULL,
};

const struct registry sensors = {"sensor", entries};

bool sensor_reaches(const struct object *self, const double origin[3]) {
    static const double most = 1e18; // as shapes: squares of distances must stay finite
    for (int i = 0; i < 3; i++)
        if (!(fabs(origin[i]) < most)) {
            log_error_at(self->at, "%s: stands %g from the scene, expected less than %g",
                         self->type->name, fabs(origin[i]), most);
            return false;
        }
    return true;
}
