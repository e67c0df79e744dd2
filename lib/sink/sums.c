// SPDX-License-Identifier: Apache-2.0
#include "sink/sums.h"

#include <assert.h>
#include <string.h>

#include "base/mem.h"

void sums_init(struct sums *s, size_t values) {
    *s = (struct sums){.values = values};
}

void sums_finish(struct sums *s) {
    for (size_t i = 0; i < s->count; i++)
        mem_free(s->nodes[i].values);
    mem_free(s->nodes);
    *s = (struct sums){0};
}

uint64_t sums_node_first(const struct sums_node *node) {
    return (node->index << node->level) * SUMS_BLOCK;
}

uint64_t sums_node_samples(const struct sums_node *node) {
    return ((uint64_t)SUMS_BLOCK << node->level) - node->missing;
}

// Position of the first node that does not lie before (seed, sample).
static size_t find(const struct sums *s, uint32_t seed, uint64_t sample) {
    size_t low = 0, high = s->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const struct sums_node *n = &s->nodes[middle];
        const bool before = n->seed < seed || (n->seed == seed && sums_node_first(n) < sample);
        low = before ? middle + 1 : low;
        high = before ? high : middle;
    }
    return low;
}

// The room a node takes, short or not, is never shared.
static bool overlap(const struct sums_node *a, const struct sums_node *b) {
    const uint64_t a0 = a->index << a->level, b0 = b->index << b->level;
    return a->seed == b->seed && a0 < b0 + (1ull << b->level) && b0 < a0 + (1ull << a->level);
}

bool sums_overlap(const struct sums *s, const struct sums_node *node) {
    const size_t at = find(s, node->seed, sums_node_first(node));
    return (at < s->count && overlap(&s->nodes[at], node)) ||
           (at > 0 && overlap(&s->nodes[at - 1], node));
}

static bool are_halves(const struct sums_node *a, const struct sums_node *b) {
    return a->seed == b->seed && a->level == b->level && !a->missing && !b->missing &&
           a->index % 2 == 0 && a->index + 1 == b->index;
}

// Joins the nodes at `at` and at + 1 into their parent.
static void join(struct sums *s, size_t at) {
    struct sums_node *left = &s->nodes[at], *right = left + 1;
    for (size_t i = 0; i < s->values; i++)
        left->values[i] += right->values[i];
    mem_free(right->values);
    left->level++;
    left->index /= 2;
    memmove(right, right + 1, (s->count - at - 2) * sizeof *right);
    s->count--;
}

void sums_add(struct sums *s, struct sums_node node) {
    assert(!sums_overlap(s, &node));
    size_t at = find(s, node.seed, sums_node_first(&node));
    mem_grow(&s->nodes, &s->capacity, s->count + 1, sizeof *s->nodes);
    memmove(&s->nodes[at + 1], &s->nodes[at], (s->count - at) * sizeof *s->nodes);
    s->nodes[at] = node;
    s->count++;
    for (bool joined = true; joined;) {
        joined = false;
        if (at + 1 < s->count && are_halves(&s->nodes[at], &s->nodes[at + 1])) {
            join(s, at);
            joined = true;
        } else if (at > 0 && are_halves(&s->nodes[at - 1], &s->nodes[at])) {
            join(s, --at);
            joined = true;
        }
    }
}

bool sums_take_short(struct sums *s, uint32_t seed, struct sums_node *node) {
    const size_t after = find(s, seed + 1, 0);
    if (seed == UINT32_MAX || after == 0 || s->nodes[after - 1].seed != seed ||
        !s->nodes[after - 1].missing)
        return false;
    *node = s->nodes[after - 1];
    memmove(&s->nodes[after - 1], &s->nodes[after], (s->count - after) * sizeof *s->nodes);
    s->count--;
    return true;
}

uint64_t sums_samples(const struct sums *s) {
    return sums_samples_of_phase(s, 1, 0);
}

uint64_t sums_samples_of_phase(const struct sums *s, uint32_t period, uint32_t phase) {
    uint64_t samples = 0;
    for (size_t i = 0; i < s->count; i++)
        samples += (sums_node_samples(&s->nodes[i]) + period - 1 - phase) / period;
    return samples;
}

uint64_t sums_next(const struct sums *s, uint32_t seed, uint64_t first) {
    size_t at = find(s, seed, first + 1);
    uint64_t next = first;
    if (at > 0 && s->nodes[at - 1].seed == seed)
        at--;
    for (; at < s->count && s->nodes[at].seed == seed && sums_node_first(&s->nodes[at]) <= next; at++) {
        const uint64_t end = sums_node_first(&s->nodes[at]) + sums_node_samples(&s->nodes[at]);
        next = end > next ? end : next;
    }
    return next;
}

void sums_total(const struct sums *s, size_t first, size_t count, const double *last, double *sums) {
    memset(sums, 0, count * sizeof *sums);
    if (last)
        memcpy(sums, last, count * sizeof *sums);
    for (size_t n = s->count; n-- > 0;) {
        const double *values = s->nodes[n].values + first;
        for (size_t i = 0; i < count; i++)
            sums[i] = values[i] + sums[i];
    }
}
