// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "kernels/tile.h"
#include "replay/budget_data.h"

// ---- order --------------------------------------------------------------------------------------

struct place {
    uint64_t code;
    uint32_t lane;
};

static uint64_t spread(uint32_t v) {
    uint64_t out = 0;
    for (int i = 0; i < 32; i++)
        out |= (uint64_t)(v >> i & 1) << 2 * i;
    return out;
}

static int by_code(const void *a, const void *b) {
    const struct place *x = a, *y = b;
    return x->code < y->code ? -1 : x->code > y->code;
}

void budget_order(struct budget_block *b, uint32_t width, struct arena *arena) {
    const uint64_t n = b->from.pixel_count, lanes = tensor_tiles(&b->from) * TENSOR_LANES;
    struct place *places = mem_array(n, sizeof *places);
    b->order = arena_alloc(arena, (lanes + 1) * sizeof *b->order);
    b->pixels = arena_alloc(arena, (lanes + 1) * sizeof *b->pixels);
    b->view = b->from.view ? arena_alloc(arena, (lanes + 1) * sizeof *b->view) : NULL;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t p = b->from.pixels[i];
        places[i] = (struct place){spread(p % width) | spread(p / width) << 1, i};
    }
    qsort(places, n, sizeof *places, by_code);
    for (uint64_t i = 0; i < lanes; i++) {
        b->order[i] = places[i < n ? i : n - 1].lane;
        b->pixels[i] = b->from.pixels[b->order[i]];
        if (b->view)
            b->view[i] = i < n ? b->from.view[b->order[i]] : 0;
    }
    mem_free(places);
}

bool budget_gather(const struct budget_block *b, bool halves, size_t tile, uint32_t coefficient,
                   float row[ROW_VALUES]) {
    const void *data = halves ? b->from.halves : b->from.values;
    const float *f = data;
    const uint16_t *h = data;
    for (uint32_t lane = 0; lane < TILE_LANES; lane++) {
        const uint32_t old = b->order[tile * TILE_LANES + lane];
        const size_t at = (old / TILE_LANES * (size_t)b->from.coefficients + coefficient) * ROW_VALUES +
                          old % TILE_LANES;
        for (uint32_t k = 0; k < TILE_CHANNELS; k++)
            row[k * TILE_LANES + lane] = b->from.storage == TENSOR_BF16
                                             ? bf16_to_float(h[at + k * TILE_LANES])
                                             : f[at + k * TILE_LANES];
    }
    bool any = false;
    for (uint32_t i = 0; i < ROW_VALUES; i++)
        any |= row[i] != 0;
    return any;
}

// ---- pictures -----------------------------------------------------------------------------------

struct pass {
    const struct budget *all;
    struct budget_block *block;
    uint32_t index;
    bool halves, errors;
    float *const *out;
};

// What a row differs by if it is stored in some way.
static void find_error(uint32_t way, const float row[ROW_VALUES], float error[ROW_VALUES]) {
    _Alignas(16) unsigned char bytes[4 * ROW_VALUES] = {0};
    row_ways[way]->encode(row, bytes);
    row_ways[way]->decode(bytes, error);
    for (int i = 0; i < ROW_VALUES; i++)
        error[i] -= row[i];
}

static void add_tile(void *ctx, size_t tile, int worker) {
    const struct pass *p = ctx;
    const struct budget_block *b = p->block;
    const size_t plane = (size_t)p->all->tensor->width * p->all->tensor->height;
    float sum[TRIALS][ROW_VALUES] = {{0}}, row[ROW_VALUES], error[ROW_VALUES];
    (void)worker;
    for (uint32_t c = 0; c < b->from.coefficients; c++) {
        if (!budget_gather(b, p->halves, tile, c, row))
            continue;
        if (p->errors)
            find_error(b->ways[p->halves][tile * b->from.coefficients + c], row, error);
        for (int t = 0; t < TRIALS; t++)
            for (uint32_t k = 0; k < TILE_CHANNELS; k++) {
                const float w = p->all->weights[t][p->index][c * TILE_CHANNELS + k];
                for (uint32_t i = k * TILE_LANES; i < (k + 1) * TILE_LANES; i++)
                    sum[t][i] += w * (p->errors ? error[i] : row[i]);
            }
    }
    for (uint32_t i = 0; i < ROW_VALUES; i++) {
        const uint64_t lane = tile * TILE_LANES + i % TILE_LANES;
        for (int t = 0; t < TRIALS && lane < b->from.pixel_count; t++)
            p->out[t][i / TILE_LANES * plane + b->pixels[lane]] +=
                sum[t][i] * (b->factor ? b->factor[tile * ROW_VALUES + i] : 1);
    }
}

void budget_pictures(struct budget *b, bool halves, bool errors, float *const out[TRIALS]) {
    for (uint32_t i = 0; i < b->tensor->block_count; i++) {
        struct pass p = {b, &b->blocks[i], i, halves, errors, out};
        if (!halves || b->blocks[i].from.halves)
            thread_for(b->options->threads, tensor_tiles(&b->blocks[i].from), add_tile, &p);
    }
}

// ---- costs --------------------------------------------------------------------------------------

// What a squared error of each of a tile's sums adds to relMSE.
static void tile_loss(const struct pass *p, int trial, size_t tile, float loss[ROW_VALUES]) {
    const struct budget_block *b = p->block;
    const size_t plane = (size_t)p->all->tensor->width * p->all->tensor->height;
    for (uint32_t i = 0; i < ROW_VALUES; i++) {
        const uint64_t lane = tile * TILE_LANES + i % TILE_LANES;
        const float f = b->factor ? b->factor[tile * ROW_VALUES + i] : 1;
        loss[i] = lane < b->from.pixel_count
                      ? f * f * p->all->loss[trial][i / TILE_LANES * plane + b->pixels[lane]] : 0;
    }
}

static float row_cost(const struct pass *p, uint32_t coefficient, const float error[ROW_VALUES],
                      const float loss[TRIALS][ROW_VALUES]) {
    float most = 0;
    for (int t = 0; t < TRIALS; t++) {
        float sum = 0;
        for (uint32_t k = 0; k < TILE_CHANNELS; k++) {
            const float w = p->all->weights[t][p->index][coefficient * TILE_CHANNELS + k];
            float own = 0;
            for (uint32_t i = k * TILE_LANES; i < (k + 1) * TILE_LANES; i++)
                own += w * error[i] * (w * error[i]) * loss[t][i];
            sum += own;
        }
        if (!isfinite(sum))
            return INFINITY;
        most = fmaxf(most, sum);
    }
    return most;
}

static void cost_tile(void *ctx, size_t tile, int worker) {
    const struct pass *p = ctx;
    const struct budget_block *b = p->block;
    float loss[TRIALS][ROW_VALUES], row[ROW_VALUES], error[ROW_VALUES];
    (void)worker;
    for (int t = 0; t < TRIALS; t++)
        tile_loss(p, t, tile, loss[t]);
    for (uint32_t c = 0; c < b->from.coefficients; c++) {
        float *costs = b->costs + (tile * b->from.coefficients + c) * ROW_WAYS;
        const bool any = budget_gather(b, p->halves, tile, c, row);
        for (uint32_t way = 0; way < ROW_WAYS; way++) {
            const bool exact = !any || way == WAY_row_float32;
            if (!exact)
                find_error(way, row, error);
            costs[way] = exact ? 0 : row_cost(p, c, error, (const float(*)[ROW_VALUES])loss);
        }
    }
}

void budget_costs(struct budget *b, bool halves) {
    for (uint32_t i = 0; i < b->tensor->block_count; i++) {
        struct pass p = {b, &b->blocks[i], i, halves, false, NULL};
        if (!halves || b->blocks[i].from.halves)
            thread_for(b->options->threads, tensor_tiles(&b->blocks[i].from), cost_tile, &p);
    }
}
