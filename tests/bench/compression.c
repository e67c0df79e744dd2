// SPDX-License-Identifier: Apache-2.0
// usage: compression T.safetensors ...
// How many coefficients of an edit tensor of direct light can be left out (Ben-Artzi 2007, 4.2.5): the
// largest threshold with which the picture of the scene as it is differs by one step of 8 bits (sRGB) at
// most, for each block, in its own basis and as Daubechies-4 wavelets.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "curve/wavelet.h"
#include "transport/tensor.h"

struct block {
    const struct tensor_block *b;
    size_t rows, columns;
    double *values;  // [pixel][channel][coefficient]
    double *weights; // [channel][coefficient]
};

static double srgb(double v) {
    v = v < 0 ? 0 : v > 1 ? 1 : v;
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055);
}

static double value_at(const struct tensor_block *b, uint64_t pixel, uint32_t c, uint32_t k) {
    const size_t i = ((pixel / TENSOR_LANES * b->coefficients + c) * 3 + k) * TENSOR_LANES +
                     pixel % TENSOR_LANES;
    return b->storage == TENSOR_BF16 ? (double)bf16_to_float(((const uint16_t *)b->values)[i])
                                     : (double)((const float *)b->values)[i];
}

static void take(struct block *t, const struct tensor_block *b, bool wavelets) {
    const uint32_t n = b->coefficients;
    double *scratch = mem_array(2 * (size_t)n, sizeof *scratch);
    t->b = b;
    t->rows = b->axis_count > 0 ? b->axes[0].bins : 1;
    t->columns = n / t->rows;
    t->values = mem_array((size_t)b->pixel_count * 3 * n, sizeof *t->values);
    t->weights = mem_array(3 * (size_t)n, sizeof *t->weights);
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t c = 0; c < n; c++)
            t->weights[k * n + c] = (double)b->weights[3 * c + k];
    for (uint64_t p = 0; p < b->pixel_count; p++)
        for (uint32_t k = 0; k < 3; k++)
            for (uint32_t c = 0; c < n; c++)
                t->values[(p * 3 + k) * n + c] = value_at(b, p, c, k);
    for (uint64_t i = 0; i < 3 * b->pixel_count && wavelets; i++)
        wavelet_forward_matrix(WAVELET_DAUB4, t->values + i * n, t->rows, t->columns, scratch);
    for (uint32_t k = 0; k < 3 && wavelets; k++)
        wavelet_forward_matrix(WAVELET_DAUB4, t->weights + k * n, t->rows, t->columns, scratch);
    mem_free(scratch);
}

// Largest difference in steps, and how many coefficients are kept.
static double try_threshold(const struct block *t, double threshold, uint64_t *kept) {
    const uint32_t n = t->b->coefficients;
    double worst = 0;
    *kept = 0;
    for (uint64_t i = 0; i < 3 * t->b->pixel_count; i++) {
        const double *v = t->values + i * n, *w = t->weights + i % 3 * n;
        double all = 0, some = 0;
        for (uint32_t c = 0; c < n; c++) {
            all += v[c] * w[c];
            if (fabs(v[c]) > threshold) {
                some += v[c] * w[c];
                ++*kept;
            }
        }
        worst = fmax(worst, fabs(srgb(all) - srgb(some)));
    }
    return worst;
}

static void measure(const struct tensor_block *b, bool wavelets) {
    struct block t;
    uint64_t kept, best;
    take(&t, b, wavelets);
    double low = 1e-12, high = 1e3;
    try_threshold(&t, 0, &best);
    const double all = 3 * (double)b->pixel_count * b->coefficients, zeros = all / (double)best;
    for (int i = 0; i < 30; i++) {
        const double middle = sqrt(low * high);
        if (try_threshold(&t, middle, &kept) <= 1) {
            low = middle;
            best = kept;
        } else {
            high = middle;
        }
    }
    printf("%s.%s %zux%zu %s: without zeros %.1f : 1, at one step of 8 bits %.1f : 1\n", b->object,
           b->term, t.rows, t.columns, wavelets ? "daub4" : "as it is", zeros, all / (double)best);
    mem_free(t.values);
    mem_free(t.weights);
}

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        struct tensor_file *f = tensor_open(argv[i]);
        if (!f)
            return 1;
        const struct tensor *t = tensor_get(f);
        for (uint32_t k = 0; k < t->block_count; k++) {
            const struct tensor_block *b = &t->blocks[k];
            measure(b, false);
            if (wavelet_fits(b->coefficients))
                measure(b, true);
        }
        tensor_close(f);
    }
    return 0;
}
