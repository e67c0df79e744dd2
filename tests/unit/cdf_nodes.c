// SPDX-License-Identifier: Apache-2.0
// The entry that cdf_nodes finds is that of a walk along the sums, for one number and for many,
// around the counts at which a level begins and with entries of no weight.
#include "check.h"
#include "math/cdf_nodes.h"
#include "math/hash.h"

enum { ROWS = 5, NUMBERS = 20000 };

static void fill(struct cdf_nodes *n, int count, struct rng *rng) {
    for (size_t row = 0; row < ROWS; row++) {
        float *sums = cdf_nodes_row(n, row);
        double sum = 0;
        sums[0] = 0;
        for (int i = 0; i < count; i++) {
            sum += rng_float(rng) < 0.3f ? 0 : (double)rng_float(rng);
            sums[i + 1] = (float)sum;
        }
        for (int i = 1; i <= count; i++)
            sums[i] = i < count && sum > 0 ? minf(sums[i] / (float)sum, 1) : 1;
        cdf_nodes_index(n, row);
    }
}

static uint32_t walk(const float *sums, int count, float u) {
    int i = 0;
    for (int k = 1; k < count; k++)
        i = sums[k] <= u ? k : i;
    return (uint32_t)i;
}

static void check_count_of(int count) {
    struct rng rng = {(uint64_t)count};
    struct cdf_nodes n;
    int wrong = 0;
    cdf_nodes_init(&n, ROWS, count);
    fill(&n, count, &rng);
    for (int k = 0; k < NUMBERS / count + 2; k++) {
        uint32_t row[WIDE_LANES], found[WIDE_LANES];
        float u[WIDE_LANES];
        for (int i = 0; i < WIDE_LANES; i++) {
            row[i] = rng_u32(&rng) % ROWS;
            const float edge = cdf_nodes_row(&n, row[i])[rng_u32(&rng) % (uint32_t)count];
            u[i] = i % 2 && edge < 1 ? edge : rng_float(&rng);
        }
        cdf_nodes_find_all(&n, WIDE_LANES, row, u, found);
        for (int i = 0; i < WIDE_LANES; i++) {
            const uint32_t right = walk(cdf_nodes_row(&n, row[i]), count, u[i]);
            wrong += found[i] != right || cdf_nodes_find(&n, row[i], u[i]) != right;
        }
    }
    cdf_nodes_finish(&n);
    printf("%d entries: %d wrong\n", count, wrong);
    CHECK(wrong == 0);
}

int main(void) {
    static const int counts[] = {1, 2, 14, 15, 16, 17, 31, 32, 255, 256, 257, 2048, 4095, 4096, 5000};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        check_count_of(counts[i]);
    return check_result();
}
