// SPDX-License-Identifier: Apache-2.0
// Pixels of one picture, and of pictures with neighbouring seeds, draw different random numbers:
// two that drew the same would carry the same noise, and their sum more of it than it says.
#include <stdlib.h>

#include "check.h"
#include "sampler/sampler.h"

enum { SEEDS = 8, WIDTH = 1024, HEIGHT = 4, REPLICATES = 4, COUNT = SEEDS * WIDTH * HEIGHT * REPLICATES };

static int compare(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

int main(void) {
    static uint32_t seeds[COUNT];
    int n = 0, equal = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++)
        for (uint32_t i = 0; i < WIDTH * HEIGHT * REPLICATES; i++)
            seeds[n++] = sampler_start(&sampler_independent, i % WIDTH, i / WIDTH % HEIGHT,
                                       i / WIDTH / HEIGHT, 64, REPLICATES, seed).seed;
    qsort(seeds, COUNT, sizeof *seeds, compare);
    for (int i = 1; i < COUNT; i++)
        equal += seeds[i] == seeds[i - 1];
    // of random 32-bit numbers COUNT^2 / 2^33 = 2 are equal; more than 12 by chance in 1e6 tests
    printf("%d of %d pixels draw the numbers of another\n", equal, COUNT);
    CHECK(equal <= 12);
    return check_result();
}
