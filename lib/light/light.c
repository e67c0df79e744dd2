// SPDX-License-Identifier: Apache-2.0
#include "light/light.h"

static const struct entry *const entries[] = {
#define X(name) &light_##name.entry,
#include "light/list.h"
#undef X
    NULL,
};

const struct registry lights = {"light", entries};
