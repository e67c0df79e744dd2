// SPDX-License-Identifier: Apache-2.0
#include "integrator/integrator.h"

static const struct entry *const entries[] = {
#define X(name) &integrator_##name.entry,
#include "integrator/list.h"
#undef X
    NULL,
};

const struct registry integrators = {"integrator", entries};
