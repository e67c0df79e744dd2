// SPDX-License-Identifier: Apache-2.0
#include "transport/tensor_parts.h"

#include "base/log.h"

int64_t tensor_samples(const struct tensor *t) {
    int64_t n = 0;
    json_read_integer(json_get(t->meta, "samples"), &n);
    return n;
}

static bool fail(const char *path, const char *what) {
    log_error("%s: %s", path, what);
    return false;
}

// ---- seeds --------------------------------------------------------------------------------------

// What a tensor is made of: its "merged", or itself. Their number.
static size_t parts_of(const struct tensor *t, size_t i, int64_t *seed, int64_t *samples) {
    const struct json *merged = json_get(t->meta, "merged");
    const struct json *at = merged ? json_at(merged, i) : t->meta;
    *seed = *samples = 0;
    json_read_integer(json_get(at, "seed"), seed);
    json_read_integer(json_get(at, "samples"), samples);
    return merged ? json_count(merged) : 1;
}

// Two of one seed are not independent.
bool tensor_list_seeds(const struct tensor *const *t, const char *const *paths, size_t count,
                       struct json *meta) {
    struct json *list = json_add_array(meta, "merged");
    for (size_t s = 0; s < count; s++) {
        int64_t seed, samples, other;
        const size_t n = parts_of(t[s], 0, &seed, &samples);
        for (size_t i = 0; i < n; i++) {
            parts_of(t[s], i, &seed, &samples);
            for (size_t k = 0; k < json_count(list); k++)
                if (json_read_integer(json_get(json_at(list, k), "seed"), &other) && other == seed)
                    return fail(paths[s], "has a seed that is among the others: it adds nothing new");
            struct json *part = json_append_object(list);
            json_add_count(part, "seed", seed);
            json_add_count(part, "samples", samples);
        }
    }
    return true;
}

// ---- ranges -------------------------------------------------------------------------------------

static bool range_of(const struct tensor *t, int64_t range[2]) {
    const struct json *j = json_get(t->meta, "range");
    return json_count(j) == 2 && json_read_integer(json_at(j, 0), &range[0]) &&
           json_read_integer(json_at(j, 1), &range[1]) && range[0] >= 0 && range[1] > range[0];
}

bool tensor_are_ranges(const struct tensor *const *t, size_t count) {
    int64_t a[2], b[2];
    for (size_t s = 1; s < count; s++)
        if (range_of(t[0], a) && range_of(t[s], b) && (a[0] != b[0] || a[1] != b[1]))
            return true;
    return false;
}

// The end of the one range that begins at `first`; 0: there is none, or more than one.
static int64_t end_of(const struct tensor *const *t, size_t count, int64_t first) {
    int64_t range[2], end = 0;
    for (size_t s = 0; s < count; s++)
        if (range_of(t[s], range) && range[0] == first) {
            if (end)
                return 0;
            end = range[1];
        }
    return end;
}

// Ranges must follow each other and see the same positions of pixels.
bool tensor_join_ranges(const struct tensor *const *t, const char *const *paths, size_t count,
                        struct json *meta) {
    int64_t first = INT64_MAX, end, range[2], seed[2], samples[2];
    for (size_t s = 0; s < count; s++) {
        parts_of(t[0], 0, &seed[0], &samples[0]);
        if (!range_of(t[s], range) || parts_of(t[s], 0, &seed[1], &samples[1]) != 1 ||
            seed[0] != seed[1] || samples[0] != samples[1])
            return fail(paths[s], "is no range of lights of the same seed and samples");
        first = range[0] < first ? range[0] : first;
    }
    end = first;
    for (size_t s = 0; s < count; s++) {
        const int64_t next = end_of(t, count, end);
        if (!next) {
            log_error("%s: of those to be merged, none, or more than one, has the lights from %lld on",
                      paths[0], (long long)end);
            return false;
        }
        end = next;
    }
    struct json *joined = json_add_array(meta, "range");
    json_append_count(joined, first);
    json_append_count(joined, end);
    return true;
}
