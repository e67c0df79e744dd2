// SPDX-License-Identifier: Apache-2.0
#include "replay/edit_stage.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "curve/wavelet.h"
#include "kernels/tile.h"
#include "replay/importance.h"
#include "replay/tiles.h"

enum { CHANNELS = TILE_CHANNELS, ROW = TILE_CHANNELS * TILE_LANES };

bool edit_stage_init(struct edit_stage *s, const struct tensor *t, const struct replay_options *o) {
    s->tensor = *t;
    if (!s->blocks)
        s->blocks = mem_array(t->block_count, sizeof *s->blocks);
    for (uint32_t i = 0; i < t->block_count; i++)
        if (t->blocks[i].pixel_count > 0)
            s->blocks[i].weights =
                mem_array(CHANNELS * (size_t)t->blocks[i].coefficients, sizeof(float));
    s->replay = replay_create(&s->tensor, o);
    return s->replay != NULL;
}

void edit_stage_finish(struct edit_stage *s) {
    replay_destroy(s->replay);
    for (uint32_t i = 0; i < s->tensor.block_count && s->blocks; i++) {
        struct edit_stage_block *b = &s->blocks[i];
        mem_free(b->weights);
        mem_free(b->effective.effective);
        mem_free(b->importance);
        mem_free(b->index);
        mem_free(b->order);
        mem_free(b->difference);
        mem_free(b->memory);
    }
    mem_free(s->blocks);
    *s = (struct edit_stage){0};
}

float *edit_stage_values(struct edit_stage_block *b, size_t floats) {
    b->memory = mem_array(floats * sizeof(float) + TENSOR_ALIGN, 1);
    const uintptr_t at = (uintptr_t)b->memory;
    return (float *)(at + (TENSOR_ALIGN - at % TENSOR_ALIGN) % TENSOR_ALIGN);
}

// ---- wavelets -----------------------------------------------------------------------------------

void edit_stage_transform(struct edit_stage *s, uint32_t block, uint32_t runs, uint32_t bins,
                          int threads) {
    enum { TILES_AT_ONCE = 64 };
    struct edit_stage_block *b = &s->blocks[block];
    const struct tensor_block *t = &s->tensor.blocks[block];
    const size_t tiles = tensor_tiles(t), n = t->coefficients;
    float *values = (float *)t->values;
    if (bins >= 4 && wavelet_fits(bins)) {
        float *scratch = mem_array((size_t)TILES_AT_ONCE * bins * ROW, sizeof *scratch);
        for (size_t run = 0; run < tiles * runs; run += TILES_AT_ONCE) {
            const size_t left = tiles * runs - run;
            tiles_daubechies4(values + run * bins * ROW, scratch, bins, bins,
                              left < TILES_AT_ONCE ? left : TILES_AT_ONCE, threads);
        }
        mem_free(scratch);
        b->runs = runs;
        b->bins = bins;
    }
    b->importance = mem_array(n, sizeof *b->importance);
    importance_of(t, threads, b->importance);
    b->effective = (struct incremental){n, CHANNELS, mem_array(CHANNELS * n, sizeof(double)),
                                        b->importance};
    b->index = mem_array(s->terms, sizeof *b->index);
    b->difference = mem_array(CHANNELS * (size_t)s->terms, sizeof *b->difference);
    b->order = mem_array(n, sizeof *b->order);
}

// Weights of bins to weights of wavelets, run by run and channel by channel.
static void transform_weights(const struct edit_stage_block *b, const double *weights, double *out) {
    double *line = mem_array(2 * (size_t)b->bins, sizeof *line);
    for (size_t run = 0; run < b->runs; run++)
        for (size_t k = 0; k < CHANNELS; k++) {
            for (size_t j = 0; j < b->bins; j++)
                line[j] = weights[(run * b->bins + j) * CHANNELS + k];
            wavelet_forward_d(WAVELET_DAUB4, line, b->bins, line + b->bins);
            for (size_t j = 0; j < b->bins; j++)
                out[(run * b->bins + j) * CHANNELS + k] = line[j];
        }
    mem_free(line);
}

// ---- following ----------------------------------------------------------------------------------

void edit_stage_begin(struct edit_stage *s) {
    s->exact = true;
    s->coefficients = s->bytes = 0;
}

static bool make_anew(struct edit_stage *s, uint32_t block, const float *weights) {
    struct edit_stage_block *b = &s->blocks[block];
    const struct tensor_block *t = &s->tensor.blocks[block];
    const size_t n = CHANNELS * (size_t)t->coefficients;
    memcpy(b->weights, weights, n * sizeof *weights);
    for (size_t i = 0; i < n && b->effective.effective; i++)
        b->effective.effective[i] = (double)weights[i];
    b->known = true;
    b->drifted = false;
    s->coefficients += t->coefficients;
    s->bytes += tensor_bytes(t);
    return replay_product(s->replay, block, b->weights);
}

static bool update(struct edit_stage *s, uint32_t block, const float *weights) {
    struct edit_stage_block *b = &s->blocks[block];
    const struct tensor_block *t = &s->tensor.blocks[block];
    const size_t n = CHANNELS * (size_t)t->coefficients;
    double *wanted = mem_array(n, sizeof *wanted);
    for (size_t i = 0; i < n; i++)
        wanted[i] = (double)weights[i];
    const size_t count =
        incremental_step(&b->effective, wanted, s->terms, b->index, b->difference, b->order);
    bool exact = true;
    for (size_t i = 0; i < n; i++)
        exact = exact && wanted[i] == b->effective.effective[i];
    mem_free(wanted);
    if (count == 0)
        return !b->drifted || make_anew(s, block, weights);
    float *change = mem_array(CHANNELS * count, sizeof *change);
    for (size_t i = 0; i < CHANNELS * count; i++)
        change[i] = (float)b->difference[i];
    const bool done = replay_update(s->replay, block, b->index, change, (uint32_t)count);
    mem_free(change);
    b->drifted = true;
    s->exact = s->exact && exact;
    s->coefficients += count;
    s->bytes += count * tensor_bytes(t) / t->coefficients;
    return done;
}

static bool all_finite(const float *weights, size_t n) {
    for (size_t i = 0; i < n; i++)
        if (!isfinite(weights[i]))
            return false;
    return true;
}

bool edit_stage_follow(struct edit_stage *s, uint32_t block, const double *weights) {
    struct edit_stage_block *b = &s->blocks[block];
    const struct tensor_block *t = &s->tensor.blocks[block];
    const size_t n = CHANNELS * (size_t)t->coefficients;
    float *now = mem_array(n, sizeof *now);
    double *wavelets = b->bins ? mem_array(n, sizeof *wavelets) : NULL;
    if (b->bins)
        transform_weights(b, weights, wavelets);
    for (size_t i = 0; i < n; i++)
        now[i] = (float)(wavelets ? wavelets[i] : weights[i]);
    bool good = all_finite(now, n);
    if (!good)
        log_error("%s.%s: the edit makes numbers beyond single precision", t->object, t->term);
    else if (b->known && b->effective.effective)
        good = update(s, block, now);
    else if (!b->known || memcmp(now, b->weights, n * sizeof *now) != 0)
        good = make_anew(s, block, now);
    mem_free(wavelets);
    mem_free(now);
    return good;
}
