// SPDX-License-Identifier: Apache-2.0
#include "curve/largest.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

struct ranked {
    double size; // squared
    uint32_t index;
};

static int by_size(const void *a, const void *b) {
    const struct ranked *x = a, *y = b;
    if (x->size != y->size)
        return x->size > y->size ? -1 : 1;
    return x->index < y->index ? -1 : x->index > y->index;
}

void keep_largest(float *weights, uint32_t count, uint32_t keep) {
    struct ranked *r = mem_array(count, sizeof *r);
    for (uint32_t i = 0; i < count; i++) {
        double size = 0;
        for (uint32_t k = 0; k < 3; k++)
            size += (double)weights[3 * i + k] * (double)weights[3 * i + k];
        r[i] = (struct ranked){size, i};
    }
    qsort(r, count, sizeof *r, by_size);
    for (uint32_t i = keep; i < count; i++)
        memset(weights + 3 * (size_t)r[i].index, 0, 3 * sizeof *weights);
    mem_free(r);
}
