// SPDX-License-Identifier: Apache-2.0
#include "replay/importance.h"

#include <math.h>

#include "base/thread.h"
#include "kernels/tile.h"

enum { ROW = TILE_CHANNELS * TILE_LANES };

struct means {
    const struct tensor_block *block;
    double *out;
};

static void root_mean_square(void *ctx, size_t coefficient, int worker) {
    const struct means *m = ctx;
    const struct tensor_block *b = m->block;
    double sum = 0;
    (void)worker;
    float row[ROW];
    const struct tensor_data values = tensor_values_of(b);
    for (size_t tile = 0; tile < tensor_tiles(b); tile++) {
        tensor_row(&values, b->coefficients, tile, (uint32_t)coefficient, row);
        for (size_t i = 0; i < ROW; i++)
            sum += (double)row[i] * (double)row[i];
    }
    m->out[coefficient] = sqrt(sum / (double)(TILE_CHANNELS * b->pixel_count));
}

void importance_of(const struct tensor_block *b, int threads, double *out) {
    struct means m = {b, out};
    thread_for(threads, b->coefficients, root_mean_square, &m);
}
