// SPDX-License-Identifier: Apache-2.0
#include "transport/rows.h"

#include <assert.h>
#include <string.h>

#define X(name) &name,
const struct row_way *const row_ways[ROW_WAYS] = {
#include "transport/list.h"
};
#undef X

static_assert((int)ROW_WAYS <= 1 << ROW_WAY_BITS, "a way has a number of its own");

void row_read(const struct tensor_rows *r, const void *data, uint32_t coefficients, size_t tile,
              uint32_t coefficient, float *values) {
    const uint32_t entry = r->entries[tile * coefficients + coefficient];
    const size_t offset = (size_t)(entry >> ROW_WAY_BITS) * ROW_UNIT;
    row_ways[row_way_of(entry)]->decode((const char *)data + r->starts[tile] + offset, values);
}

void row_add_values(const float *restrict values, const float *weight, struct row_sums *restrict sums) {
    for (int c = 0; c < ROW_CHANNELS; c++)
        for (int i = c * ROW_LANES; i < (c + 1) * ROW_LANES; i++)
            sums->lane[i] += weight[c] * values[i];
}

// ---- products -----------------------------------------------------------------------------------

enum { ROWS_AT_ONCE = 64 };

static void add_some(const uint32_t *entries, const char *tile, const uint32_t *index,
                     const float *weight, uint32_t count, struct row_sums *sums) {
    uint8_t sorted[ROW_WAYS][ROWS_AT_ONCE];
    uint32_t n[ROW_WAYS] = {0};
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t way = row_way_of(entries[index ? index[k] : k]);
        sorted[way][n[way]++] = (uint8_t)k;
    }
    for (uint32_t way = WAY_row_zero + 1; way < ROW_WAYS; way++)
        for (uint32_t i = 0; i < n[way]; i++) {
            const uint32_t k = sorted[way][i], entry = entries[index ? index[k] : k];
            row_ways[way]->add(tile + (size_t)(entry >> ROW_WAY_BITS) * ROW_UNIT,
                               weight + (size_t)k * ROW_CHANNELS, sums);
        }
}

void rows_add(const struct tensor_rows *r, const void *data, uint32_t coefficients, size_t tile,
              const uint32_t *index, const float *weight, uint32_t count, float *sum) {
    const uint32_t *entries = r->entries + tile * coefficients;
    struct row_sums s = {.base = {0}};
    memcpy(s.lane, sum, sizeof s.lane);
    for (uint32_t k = 0; k < count; k += ROWS_AT_ONCE)
        add_some(index ? entries : entries + k, (const char *)data + r->starts[tile],
                 index ? index + k : NULL, weight + (size_t)k * ROW_CHANNELS,
                 count - k < ROWS_AT_ONCE ? count - k : ROWS_AT_ONCE, &s);
    for (int i = 0; i < ROW_VALUES; i++)
        sum[i] = s.lane[i] + (s.mean[i / 4] + s.base[i / ROW_LANES]);
}

const char *rows_fault(const struct tensor_rows *r, uint64_t tiles, uint64_t coefficients,
                       uint64_t bytes) {
    if (r->starts[0] != 0 || r->starts[tiles] != bytes)
        return "do not begin or end where their bytes do";
    for (uint64_t t = 0; t < tiles; t++) {
        if (r->starts[t + 1] < r->starts[t] || r->starts[t] % ROW_TILE_ALIGN)
            return "have a tile that does not begin behind the one before";
        const uint64_t size = r->starts[t + 1] - r->starts[t];
        for (uint64_t c = 0; c < coefficients; c++) {
            const uint32_t entry = r->entries[t * coefficients + c], way = row_way_of(entry);
            if (way >= ROW_WAYS)
                return "have a row that is stored in no known way";
            if ((uint64_t)(entry >> ROW_WAY_BITS) * ROW_UNIT + row_ways[way]->bytes > size)
                return "have a row that ends behind its tile";
        }
    }
    return NULL;
}
