// SPDX-License-Identifier: Apache-2.0
// Which samples a tensor holds: "ranges" of its metadata, [[first, end], ...].
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "base/json.h"

struct sample_range {
    int64_t first, end;
};

// Ranges of several tensors, ascending, neighbours united.
struct sample_ranges {
    struct sample_range *list;
    size_t count, capacity;
};

// Adds the ranges of a tensor's metadata. false: it has none that make sense, or samples are there
// already; the list is to be given up then.
bool sample_ranges_add(struct sample_ranges *r, const struct json *meta);
void sample_ranges_describe(const struct sample_ranges *r, struct json *meta); // in place of the old
void sample_ranges_finish(struct sample_ranges *r);
