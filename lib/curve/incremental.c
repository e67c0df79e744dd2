// SPDX-License-Identifier: Apache-2.0
#include "curve/incremental.h"

#include <math.h>

static double urgency(const struct incremental *s, const double *wanted, uint32_t i) {
    double sum = 0;
    for (size_t k = i * s->channels; k < (i + (size_t)1) * s->channels; k++)
        sum += (wanted[k] - s->effective[k]) * (wanted[k] - s->effective[k]);
    return sqrt(sum) * (s->weight ? s->weight[i] : 1);
}

static int is_off(const struct incremental *s, const double *wanted, uint32_t i) {
    for (size_t k = i * s->channels; k < (i + (size_t)1) * s->channels; k++)
        if (wanted[k] != s->effective[k])
            return 1;
    return 0;
}

// Restores the heap below `root` whose top is the least urgent of the kept terms.
static void sift_down(const struct incremental *s, const double *wanted, uint32_t *heap, size_t n,
                      size_t root) {
    for (;;) {
        size_t least = root;
        for (size_t child = 2 * root + 1; child <= 2 * root + 2 && child < n; child++)
            if (urgency(s, wanted, heap[child]) < urgency(s, wanted, heap[least]))
                least = child;
        if (least == root)
            return;
        const uint32_t t = heap[root];
        heap[root] = heap[least];
        heap[least] = t;
        root = least;
    }
}

// The most urgent terms that are off at all, as a heap.
static size_t choose(const struct incremental *s, const double *wanted, size_t most,
                     uint32_t *heap) {
    size_t n = 0;
    for (uint32_t i = 0; i < s->count && most > 0; i++) {
        if (!is_off(s, wanted, i))
            continue;
        if (n < most) {
            heap[n++] = i;
            for (size_t k = n == most ? n / 2 : 0; k-- > 0;)
                sift_down(s, wanted, heap, n, k);
        } else if (urgency(s, wanted, i) > urgency(s, wanted, heap[0])) {
            heap[0] = i;
            sift_down(s, wanted, heap, n, 0);
        }
    }
    for (size_t k = n / 2; k-- > 0;)
        sift_down(s, wanted, heap, n, k);
    return n;
}

size_t incremental_step(struct incremental *s, const double *wanted, size_t most, uint32_t *index,
                        double *difference, uint32_t *order) {
    const size_t n = choose(s, wanted, most, order);
    for (size_t left = n; left > 0; left--) { // the least urgent goes to the end
        const uint32_t i = order[0];
        index[left - 1] = i;
        for (size_t k = 0; k < s->channels; k++)
            difference[(left - 1) * s->channels + k] =
                wanted[i * s->channels + k] - s->effective[i * s->channels + k];
        order[0] = order[left - 1];
        sift_down(s, wanted, order, left - 1, 0);
    }
    for (size_t k = 0; k < n * s->channels; k++) {
        const size_t at = index[k / s->channels] * s->channels + k % s->channels;
        s->effective[at] = wanted[at];
    }
    return n;
}
