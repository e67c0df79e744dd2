// SPDX-License-Identifier: Apache-2.0
#include "replay/measure.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/thread.h"

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

double measure_median(double *values, size_t n) {
    qsort(values, n, sizeof *values, by_value);
    return values[n / 2];
}

// ---- memory -------------------------------------------------------------------------------------

enum { PARTS = 64, SUMS = 64 };

struct reading {
    const float *data;
    size_t floats;
    double sums[PARTS];
};

// Adds up a part, as many sums at a time as hide the latency of additions.
static void read_part(void *ctx, size_t part, int worker) {
    struct reading *r = ctx;
    const size_t n = r->floats / PARTS;
    const float *p = r->data + part * n;
    float sum[SUMS] = {0};
    (void)worker;
    for (size_t i = 0; i + SUMS <= n; i += SUMS)
        for (size_t k = 0; k < SUMS; k++)
            sum[k] += p[i + k];
    for (size_t k = 0; k < SUMS; k++)
        r->sums[part] += (double)sum[k];
}

double measure_bandwidth(int threads) {
    enum { BYTES = 1 << 28, REPEATS = 7 };
    double seconds[REPEATS];
    struct reading r = {.floats = BYTES / sizeof(float)};
    float *data = mem_array(r.floats, sizeof *data);
    for (size_t i = 0; i < r.floats; i += 1024) // pages that were never written are one and the same
        data[i] = 1;
    r.data = data;
    for (int i = 0; i < REPEATS; i++) {
        const double start = time_seconds();
        thread_for(threads, PARTS, read_part, &r);
        seconds[i] = time_seconds() - start;
    }
    volatile double keep = r.sums[0];
    (void)keep;
    mem_free(data);
    return BYTES / measure_median(seconds, REPEATS);
}

// ---- noise --------------------------------------------------------------------------------------

double measure_noise(const struct tensor *t, const float *frame, const float *variance) {
    const size_t plane = (size_t)t->width * t->height;
    double mean = 0, sum = 0;
    for (size_t i = 0; i < 3 * plane; i++)
        mean += (double)frame[i] / (3 * (double)plane);
    for (size_t i = 0; i < plane; i++) {
        const double b = ((double)frame[i] + (double)frame[plane + i] +
                          (double)frame[2 * plane + i]) / 3;
        const double scale = b * b + 1e-3 * mean * mean;
        sum += scale > 0 ? (double)variance[i] / scale / (double)plane : 0;
    }
    return sqrt(sum);
}
