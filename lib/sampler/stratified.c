// SPDX-License-Identifier: Apache-2.0
// One point in each cell of a grid, cells in random order. A count n that is not m x n is rounded
// up to the next grid, of which n cells are drawn at random: still unbiased for any count.
#include "sampler/strata.h"

static const struct param params[] = {
    SAMPLER_PARAMS,
    {"jitter", PARAM_IGNORED, .unit = "", .help = "points are always jittered"},
    {"dimension", PARAM_IGNORED, .unit = "", .help = "dimensions are not limited"},
    PARAM_END,
};

static struct vec2 next_2d(struct sampler *s) {
    const struct strata_seeds k = strata_next(s);
    const uint32_t columns = strata_columns(s->count);
    const uint32_t rows = (s->count + columns - 1) / columns;
    const uint32_t cell = permute(s->index % (columns * rows), columns * rows, k.order);
    return (struct vec2){
        strata_inside(cell % columns, uniform_float((uint32_t)(k.jitter >> 32)), columns),
        strata_inside(cell / columns, uniform_float((uint32_t)k.jitter), rows)};
}

const struct sampler_type sampler_stratified = {
    .entry = {.name = "stratified", .help = "jittered grid", .params = params,
              .size = sizeof(struct sampler_settings)},
    .next_1d = strata_next_1d, .next_2d = next_2d,
    .counted = true,
};
