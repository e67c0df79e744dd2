// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "base/mem.h"
#include "transport/tensor.h"

void tensor_row(const struct tensor_data *d, uint32_t coefficients, size_t tile, uint32_t coefficient,
                float values[ROW_VALUES]) {
    const size_t at = (tile * coefficients + coefficient) * ROW_VALUES;
    if (d->storage == TENSOR_ROWS)
        row_read(&d->rows, d->data, coefficients, tile, coefficient, values);
    else if (d->storage == TENSOR_F32)
        memcpy(values, (const float *)d->data + at, ROW_VALUES * sizeof *values);
    else
        row_bfloat16.decode((const uint16_t *)d->data + at, values);
}

static float *unpack(const struct tensor_block *b, const struct tensor_data *d) {
    float *values = mem_array(tensor_value_count(b), sizeof *values), *row = values;
    for (uint64_t t = 0; t < tensor_tiles(b); t++)
        for (uint32_t c = 0; c < b->coefficients; c++, row += ROW_VALUES)
            tensor_row(d, b->coefficients, t, c, row);
    return values;
}

struct tensor_block tensor_unpack(const struct tensor_block *b, float *memory[2]) {
    struct tensor_block out = *b;
    mem_free(memory[0]);
    mem_free(memory[1]);
    memory[0] = memory[1] = NULL;
    if (b->storage != TENSOR_ROWS)
        return out;
    const struct tensor_data values = tensor_values_of(b), halves = tensor_halves_of(b);
    out.storage = TENSOR_F32;
    out.values = memory[0] = unpack(b, &values);
    out.halves = memory[1] = halves.data ? unpack(b, &halves) : NULL;
    return out;
}
