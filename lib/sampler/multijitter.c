// SPDX-License-Identifier: Apache-2.0
// Correlated multi-jittered points for any count (Kensler 2013): stratified in a grid and in both
// projections. y alone is exact in `count` strata; x uses the full grid, so that with an
// incomplete last row its columns are chosen at random.
#include "sampler/strata.h"

static const struct param params[] = {
    SAMPLER_PARAMS,
    {"jitter", PARAM_IGNORED, .unit = "", .help = "points are always jittered"},
    PARAM_END,
};

static struct vec2 next_2d(struct sampler *s) {
    const struct strata_seeds k = strata_next(s);
    const uint32_t columns = strata_columns(s->count);
    const uint32_t rows = (s->count + columns - 1) / columns;
    const uint32_t i = permute(s->index % s->count, s->count, k.order);
    const uint32_t column = permute(i % columns, columns, k.a);
    const uint32_t row = permute(i / columns, rows, k.b);
    const float jx = uniform_float((uint32_t)(k.jitter >> 32));
    const float x = ((float)row + jx) / (float)rows;
    return (struct vec2){strata_inside(column, x, columns),
                         strata_inside(i, uniform_float((uint32_t)k.jitter), s->count)};
}

const struct sampler_type sampler_multijitter = {
    .entry = {.name = "multijitter", .help = "correlated multi-jittered points (Kensler 2013)",
              .params = params, .size = sizeof(struct sampler_settings)},
    .next_1d = strata_next_1d, .next_2d = next_2d,
    .counted = true,
};
