// SPDX-License-Identifier: Apache-2.0
#include "rows_sample.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static void *aligned(struct arena *arena, size_t bytes) {
    const uintptr_t at = (uintptr_t)arena_alloc(arena, bytes + 2 * TENSOR_ALIGN);
    return (void *)(at + (TENSOR_ALIGN - at % TENSOR_ALIGN) % TENSOR_ALIGN);
}

struct tensor_rows rows_encode(const uint8_t *ways, const float *values, uint64_t tiles,
                               uint32_t coefficients, const void **data, struct arena *arena) {
    uint32_t *entries = aligned(arena, tiles * coefficients * sizeof *entries);
    uint64_t *starts = aligned(arena, (tiles + 1) * sizeof *starts);
    starts[0] = 0;
    for (uint64_t t = 0; t < tiles; t++) {
        uint64_t at = 0;
        for (uint32_t c = 0; c < coefficients; c++) {
            const uint32_t way = ways[t * coefficients + c];
            entries[t * coefficients + c] = row_entry(way, at);
            at += row_ways[way]->bytes;
        }
        starts[t + 1] = starts[t] + (at + ROW_TILE_ALIGN - 1) / ROW_TILE_ALIGN * ROW_TILE_ALIGN;
    }
    char *bytes = aligned(arena, starts[tiles]);
    memset(bytes, 0, starts[tiles]);
    for (uint64_t i = 0; i < tiles * coefficients; i++)
        row_ways[ways[i]]->encode(values + i * ROW_VALUES,
                                  bytes + starts[i / coefficients] +
                                      (size_t)(entries[i] >> ROW_WAY_BITS) * ROW_UNIT);
    *data = bytes;
    return (struct tensor_rows){entries, starts};
}

struct tensor_block rows_sample(uint64_t pixels, uint32_t coefficients, struct arena *arena) {
    uint32_t *list = aligned(arena, pixels * sizeof *list);
    struct tensor_block b = {.object = "", .term = "", .axis_count = 1, .groups = 1,
                             .coefficients = coefficients, .channels = 3, .pixel_count = pixels,
                             .axes = {{"theta_h", TENSOR_BOX, coefficients, NULL}}, .pixels = list,
                             .storage = TENSOR_ROWS};
    const uint64_t tiles = tensor_tiles(&b), n = tensor_value_count(&b);
    float *values = arena_alloc(arena, n * sizeof *values);
    uint8_t *ways = arena_alloc(arena, tiles * coefficients);
    for (uint64_t i = 0; i < pixels; i++)
        list[i] = (uint32_t)i;
    for (uint64_t i = 0; i < n; i++)
        values[i] = (float)rand() / (float)RAND_MAX - 0.1f;
    for (uint64_t i = 0; i < tiles * coefficients; i++)
        ways[i] = (uint8_t)((uint32_t)rand() % ROW_WAYS);
    b.value_rows = rows_encode(ways, values, tiles, coefficients, &b.values, arena);
    b.half_rows = rows_encode(ways, values, tiles, coefficients, &b.halves, arena);
    return b;
}
