// SPDX-License-Identifier: Apache-2.0
#include "integrator/integrator.h"

#include <string.h>

static const struct entry *const entries[] = {
#define X(name) &integrator_##name.entry,
#include "integrator/list.h"
#undef X
    NULL,
};

const struct registry integrators = {"integrator", entries};

bool integrator_meters(const struct object *integrator) {
    bool meters = integrator_type_of(integrator)->meters;
    for (const struct param *p = integrator->type->params; p && p->name; p++)
        if (p->type == PARAM_INTEGRATOR) {
            const struct object *nested;
            memcpy(&nested, (const char *)integrator->data + p->offset, sizeof nested);
            meters = meters && nested && integrator_meters(nested);
        }
    return meters;
}

bool integrator_lights(const struct object *integrator) {
    bool nests = false, some = false;
    for (const struct param *p = integrator->type->params; p && p->name; p++)
        if (p->type == PARAM_INTEGRATOR) {
            const struct object *nested;
            memcpy(&nested, (const char *)integrator->data + p->offset, sizeof nested);
            nests = true;
            some = some || (nested && integrator_lights(nested));
        }
    return some || !nests;
}

bool integrator_enter(struct object *integrator, struct world *w, struct arena *arena) {
    const struct integrator_type *type = integrator_type_of(integrator);
    bool good = !type->enter || type->enter(integrator, w, arena);
    for (const struct param *p = integrator->type->params; p && p->name && good; p++)
        if (p->type == PARAM_INTEGRATOR) {
            struct object *nested;
            memcpy(&nested, (const char *)integrator->data + p->offset, sizeof nested);
            good = !nested || integrator_enter(nested, w, arena);
        }
    return good;
}
