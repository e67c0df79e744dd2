// SPDX-License-Identifier: Apache-2.0
#include "sampler/sampler.h"

static const struct entry *const entries[] = {
#define X(name) &sampler_##name.entry,
#include "sampler/list.h"
#undef X
    NULL,
};

const struct registry samplers = {"sampler", entries};
