// SPDX-License-Identifier: Apache-2.0
#include "transport/rows.h"

#include <assert.h>

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
