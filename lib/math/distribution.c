// SPDX-License-Identifier: Apache-2.0
#include "math/distribution.h"

#include "base/mem.h"
#include "math/vec.h"

static const float ONE_MINUS = 0x1.fffffep-1f; // largest float below 1

void distribution_init(struct distribution *d, const float *weights, uint32_t count) {
    d->count = count;
    d->cdf = mem_array((size_t)count + 1, sizeof *d->cdf);
    d->total = 0;
    for (uint32_t i = 0; i < count; i++)
        d->total += weights[i];
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        sum += d->total > 0 ? weights[i] / d->total : 1.0 / count;
        d->cdf[i + 1] = (float)fmin(sum, 1);
    }
    // The last entry with weight ends at exactly 1, and what follows it stays empty.
    for (uint32_t i = count; i > 0; i--) {
        const int has_weight = d->total <= 0 || weights[i - 1] > 0;
        d->cdf[i] = 1;
        if (has_weight)
            break;
    }
}

void distribution_finish(struct distribution *d) {
    mem_free(d->cdf);
    *d = (struct distribution){0};
}

uint32_t cdf_find(const float *cdf, uint32_t count, float u, float *remapped) {
    uint32_t lo = 0, hi = count; // invariant: cdf[lo] <= u < cdf[hi]
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (cdf[middle] <= u)
            lo = middle;
        else
            hi = middle;
    }
    const float width = cdf[lo + 1] - cdf[lo];
    *remapped = width > 0 ? minf((u - cdf[lo]) / width, ONE_MINUS) : 0;
    return lo;
}

uint32_t distribution_sample(const struct distribution *d, float u, float *pmf, float *remapped) {
    float within;
    const uint32_t i = cdf_find(d->cdf, d->count, u, &within);
    *pmf = distribution_pmf(d, i);
    if (remapped)
        *remapped = within;
    return i;
}

// Vose's construction; two stacks in one array, small entries from the left, large from the right.
void alias_init(struct alias_table *a, const float *weights, uint32_t count) {
    a->count = count;
    a->entries = mem_array(count, sizeof *a->entries);
    double *scaled = mem_array(count, sizeof *scaled);
    uint32_t *stack = mem_array(count, sizeof *stack);
    double total = 0;
    for (uint32_t i = 0; i < count; i++)
        total += weights[i];
    uint32_t small = 0, large = count;
    for (uint32_t i = 0; i < count; i++) {
        const double p = total > 0 ? weights[i] / total : 1.0 / count;
        scaled[i] = p * count;
        a->entries[i] = (struct alias_entry){1, i, (float)p};
        stack[scaled[i] < 1 ? small++ : --large] = i;
    }
    while (small > 0 && large < count) {
        const uint32_t s = stack[--small], l = stack[large];
        a->entries[s].threshold = (float)scaled[s];
        a->entries[s].other = l;
        scaled[l] -= 1 - scaled[s];
        if (scaled[l] < 1) {
            large++;
            stack[small++] = l;
        }
    }
    mem_free(scaled);
    mem_free(stack);
}

void alias_finish(struct alias_table *a) {
    mem_free(a->entries);
    *a = (struct alias_table){0};
}

uint32_t alias_sample(const struct alias_table *a, float u, float *pmf, float *remapped) {
    const float x = u * (float)a->count;
    uint32_t i = (uint32_t)x;
    i = i < a->count ? i : a->count - 1;
    const float inside = minf(x - (float)i, ONE_MINUS);
    const struct alias_entry *e = &a->entries[i];
    const int keep = inside < e->threshold;
    const float t = keep ? inside / e->threshold : (inside - e->threshold) / (1 - e->threshold);
    if (!keep)
        i = e->other;
    *pmf = a->entries[i].pmf;
    if (remapped)
        *remapped = minf(t, ONE_MINUS);
    return i;
}

uint32_t alias_sample_fine(const struct alias_table *a, double u, float *pmf) {
    const double x = u * a->count;
    uint32_t i = (uint32_t)x;
    i = i < a->count ? i : a->count - 1;
    if (x - i >= (double)a->entries[i].threshold)
        i = a->entries[i].other;
    *pmf = a->entries[i].pmf;
    return i;
}
