// SPDX-License-Identifier: Apache-2.0
// Products of tiles whose rows are stored in ways of their own, against the speed of memory: each way
// alone, and a mixture like that of a tensor of the Cornell box; OpenCL and C, interleaved, medians.
//
// usage: rows [ROWS [ZERO,FLOAT32,... numbers of a mixture]]     (1048576)
#include "transport/rows.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "replay/measure.h"
#include "replay/replay.h"

enum { REPEATS = 9, COEFFICIENTS = 512, SAMPLES = 64 };

struct bench {
    struct tensor_block block;
    struct tensor tensor;
    uint32_t *entries;
    uint64_t *starts;
    void *memory[3];
    float weights[3 * COEFFICIENTS];
};

static void *aligned(size_t bytes, void **memory) {
    *memory = mem_array(bytes + TENSOR_ALIGN, 1);
    const uintptr_t at = (uintptr_t)*memory;
    return (void *)(at + (TENSOR_ALIGN - at % TENSOR_ALIGN) % TENSOR_ALIGN);
}

// A way drawn with these chances.
static uint32_t draw(const double share[ROW_WAYS], uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    double u = (double)(*state >> 11) * 0x1p-53;
    uint32_t way = 0;
    while (way + 1 < ROW_WAYS && u >= share[way])
        u -= share[way++];
    return way;
}

static void fill(struct bench *b, const double share[ROW_WAYS], uint64_t tiles) {
    uint64_t state = 1, at;
    float row[ROW_VALUES];
    b->entries = aligned(tiles * COEFFICIENTS * sizeof *b->entries, &b->memory[0]);
    b->starts = aligned((tiles + 1) * sizeof *b->starts, &b->memory[1]);
    for (uint64_t t = 0; t < tiles; t++) {
        at = 0;
        for (uint32_t c = 0; c < COEFFICIENTS; c++) {
            const uint32_t way = draw(share, &state);
            b->entries[t * COEFFICIENTS + c] = row_entry(way, at);
            at += row_ways[way]->bytes;
        }
        b->starts[t + 1] = b->starts[t] + (at + ROW_TILE_ALIGN - 1) / ROW_TILE_ALIGN * ROW_TILE_ALIGN;
    }
    char *data = aligned(b->starts[tiles] + 1, &b->memory[2]);
    for (uint64_t i = 0; i < tiles * COEFFICIENTS; i++) {
        for (int k = 0; k < ROW_VALUES && i < SAMPLES; k++)
            row[k] = (float)(rand() % 1000);
        row_ways[row_way_of(b->entries[i])]->encode(
            row, data + b->starts[i / COEFFICIENTS] + (size_t)(b->entries[i] >> ROW_WAY_BITS) * ROW_UNIT);
    }
    b->block = (struct tensor_block){
        .object = "", .term = "", .axis_count = 1, .groups = 1, .coefficients = COEFFICIENTS,
        .axes = {{"theta_h", TENSOR_BOX, COEFFICIENTS, NULL}}, .channels = 3,
        .pixel_count = tiles * TENSOR_LANES, .storage = TENSOR_ROWS, .values = data,
        .value_rows = {b->entries, b->starts}};
    b->tensor = (struct tensor){.width = (uint32_t)(tiles * TENSOR_LANES), .height = 1,
                                .block_count = 1, .blocks = &b->block};
    for (int i = 0; i < 3 * COEFFICIENTS; i++)
        b->weights[i] = 1 / (float)(i + 1);
}

static void measure(const char *name, const double share[ROW_WAYS], uint64_t rows) {
    const double limit = measure_bandwidth(0); // beside it, since machines change
    struct bench b = {.entries = NULL};
    double times[2][REPEATS];
    fill(&b, share, rows / COEFFICIENTS);
    struct replay *r[2];
    for (int k = 0; k < 2; k++)
        r[k] = replay_create(&b.tensor, &(struct replay_options){.no_device = k == 1});
    for (int i = -1; i < REPEATS; i++)
        for (int k = 0; k < 2; k++) {
            const double start = time_seconds();
            replay_product(r[k], 0, b.weights);
            replay_wait(r[k]);
            times[k][i < 0 ? 0 : i] = time_seconds() - start;
        }
    const double bytes = (double)tensor_bytes(&b.block);
    for (int k = 0; k < 2; k++) {
        const double t = measure_median(times[k], REPEATS);
        printf("%-9s %-8.8s %6.1f MB, %5.1f bytes a row: %6.2f ms, %5.2f GB/s = %.2f of reading; as "
               "float32 %.1f GB/s\n", name, replay_device(r[k]), bytes * 1e-6, bytes / (double)rows, t * 1e3,
               bytes * 1e-9 / t, bytes / t / limit,
               (double)tensor_value_count(&b.block) * 4e-9 / t);
        replay_destroy(r[k]);
    }
    for (int k = 0; k < 3; k++)
        mem_free(b.memory[k]);
}

int main(int argc, char **argv) {
    const uint64_t rows = argc > 1 ? strtoull(argv[1], NULL, 10) : 1 << 20;
    double mixture[ROW_WAYS] = {0.45, 0, 0, 0, 0.15, 0.2, 0.2}, all = 0;
    char *at = argc > 2 ? argv[2] : NULL;
    for (int way = 0; way < ROW_WAYS && at; way++) {
        mixture[way] = strtod(at, &at);
        at += *at == ',';
    }
    for (int way = 0; way < ROW_WAYS; way++)
        all += mixture[way];
    for (int way = 0; way < ROW_WAYS; way++)
        mixture[way] /= all;
    measure("mixture", mixture, rows);
    for (int way = 1; way < ROW_WAYS; way++) {
        double one[ROW_WAYS] = {0};
        one[way] = 1;
        measure(row_ways[way]->name, one, rows);
    }
    return 0;
}
