// SPDX-License-Identifier: Apache-2.0
#include "transport/sample_ranges.h"

#include <string.h>

#include "base/mem.h"

static bool add(struct sample_ranges *r, struct sample_range n) {
    size_t at = 0;
    while (at < r->count && r->list[at].end < n.first)
        at++;
    if (at < r->count && r->list[at].end == n.first) { // goes on
        if (at + 1 < r->count && r->list[at + 1].first < n.end)
            return false;
        r->list[at].end = n.end;
    } else {
        if (at < r->count && r->list[at].first < n.end)
            return false;
        mem_grow(&r->list, &r->capacity, r->count + 1, sizeof *r->list);
        memmove(r->list + at + 1, r->list + at, (r->count++ - at) * sizeof *r->list);
        r->list[at] = n;
    }
    if (at + 1 < r->count && r->list[at].end == r->list[at + 1].first) {
        r->list[at].end = r->list[at + 1].end;
        memmove(r->list + at + 1, r->list + at + 2, (--r->count - at - 1) * sizeof *r->list);
    }
    return true;
}

bool sample_ranges_add(struct sample_ranges *r, const struct json *meta) {
    const struct json *ranges = json_get(meta, "ranges");
    bool good = json_is_array(ranges) && json_count(ranges) > 0;
    for (size_t i = 0; good && i < json_count(ranges); i++) {
        const struct json *range = json_at(ranges, i);
        struct sample_range n;
        good = json_count(range) == 2 && json_read_integer(json_at(range, 0), &n.first) &&
               json_read_integer(json_at(range, 1), &n.end) && 0 <= n.first && n.first < n.end &&
               add(r, n);
    }
    return good;
}

void sample_ranges_describe(const struct sample_ranges *r, struct json *meta) {
    struct json *ranges = json_add_array(meta, "ranges");
    for (size_t i = 0; i < r->count; i++) {
        struct json *range = json_append_array(ranges);
        json_append_count(range, r->list[i].first);
        json_append_count(range, r->list[i].end);
    }
}

void sample_ranges_finish(struct sample_ranges *r) {
    mem_free(r->list);
    *r = (struct sample_ranges){0};
}
