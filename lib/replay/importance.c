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
    for (size_t tile = 0; tile < tensor_tiles(b); tile++) {
        const size_t row = (tile * b->coefficients + coefficient) * ROW;
        for (size_t i = row; i < row + ROW; i++) {
            const double v = b->storage == TENSOR_BF16
                                 ? (double)bf16_to_float(((const uint16_t *)b->values)[i])
                                 : (double)((const float *)b->values)[i];
            sum += v * v;
        }
    }
    m->out[coefficient] = sqrt(sum / (double)(TILE_CHANNELS * b->pixel_count));
}

void importance_of(const struct tensor_block *b, int threads, double *out) {
    struct means m = {b, out};
    thread_for(threads, b->coefficients, root_mean_square, &m);
}
