// SPDX-License-Identifier: Apache-2.0
// Rows of coefficients, each stored as cheaply as its error allows.
//
// A row is one coefficient of a tile: 3 channels of 64 pixels. In a block of storage TENSOR_ROWS each
// row has a way of its own to be stored (list.h). Its entry holds that way's number and where its
// bytes begin in the tile, in units of 16 bytes; tiles begin at multiples of 128 bytes, so that
// any of them can be handed to a device.
//
//     entry = way | units << 4;   data = values + starts[tile] + 16 units
//
// Lanes beyond the end of a list of pixels hold anything finite.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ROW_VALUES = 192, ROW_LANES = 64, ROW_UNIT = 16, ROW_WAY_BITS = 4, ROW_TILE_ALIGN = 128 };
enum { ROW_CHANNELS = 3, ROW_MEANS = ROW_VALUES / 4 };

struct tensor_rows {
    const uint32_t *entries; // [tiles][coefficients]
    const uint64_t *starts;  // [tiles + 1], bytes
};

// What rows times weights add up to. What four lanes or all of a channel share is added up apart.
struct row_sums {
    float lane[ROW_VALUES], mean[ROW_MEANS], base[ROW_CHANNELS];
};

// A way to store a row. Values are [channel][lane] and finite; bytes are a multiple of ROW_UNIT.
struct row_way {
    const char *name, *help;
    uint32_t bytes;
    void (*encode)(const float *values, void *out);
    void (*decode)(const void *in, float *values);
    // weight[channel] times the row.
    void (*add)(const void *in, const float *weight, struct row_sums *sums);
};

// For ways that do no better than to decode: sums->lane += weight * values.
void row_add_values(const float *values, const float *weight, struct row_sums *sums);

#define X(name) extern const struct row_way name;
#include "transport/list.h"
#undef X

#define X(name) WAY_##name,
enum {
#include "transport/list.h"
    ROW_WAYS
};
#undef X

extern const struct row_way *const row_ways[ROW_WAYS];

static inline uint32_t row_entry(uint32_t way, uint64_t offset) {
    return way | (uint32_t)(offset / ROW_UNIT) << ROW_WAY_BITS;
}

static inline uint32_t row_way_of(uint32_t entry) {
    return entry & ((1u << ROW_WAY_BITS) - 1);
}

// Decodes row `coefficient` of a tile.
void row_read(const struct tensor_rows *r, const void *data, uint32_t coefficients, size_t tile,
              uint32_t coefficient, float *values);

// sum[channel][lane] += sum_k weight[k][channel] row[index[k]], or row[k] where index is NULL: 64 rows at a
// time, in the order of their ways. The twin of kernels/row_load.h, with its bits.
void rows_add(const struct tensor_rows *r, const void *data, uint32_t coefficients, size_t tile,
              const uint32_t *index, const float *weight, uint32_t count, float *sum);

// Whether all rows lie inside their tiles, and the tiles inside `bytes`. What is wrong, or NULL.
const char *rows_fault(const struct tensor_rows *r, uint64_t tiles, uint64_t coefficients,
                       uint64_t bytes);
