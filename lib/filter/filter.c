// SPDX-License-Identifier: Apache-2.0
#include "filter/filter.h"

static const struct entry *const entries[] = {
#define X(name) &filter_##name.entry,
#include "filter/list.h"
#undef X
    NULL,
};

const struct registry filters = {"filter", entries};
