// SPDX-License-Identifier: Apache-2.0
// Independent uniform numbers: SplitMix64 as a counter-based generator.
#include "sampler/sampler.h"

static const struct param params[] = {
    SAMPLER_PARAMS,
    PARAM_END,
};

static uint64_t next(struct sampler *s) {
    const uint64_t start = hash_u64((uint64_t)s->seed << 32 | s->index);
    return hash_u64(start + s->dimension++);
}

static float next_1d(struct sampler *s) {
    return uniform_float((uint32_t)(next(s) >> 32));
}

static struct vec2 next_2d(struct sampler *s) {
    const uint64_t bits = next(s);
    return (struct vec2){uniform_float((uint32_t)(bits >> 32)), uniform_float((uint32_t)bits)};
}

static void draw_wide(const struct sampler_lanes *s, wide_uint dimension, wide u[2]) {
    const struct wide_u64 start = wide_hash_u64(wide_join(s->seed, s->index));
    const struct wide_u64 d = wide_widen(dimension);
    const struct wide_u64 bits = wide_hash_u64((struct wide_u64){start.a + d.a, start.b + d.b});
    u[0] = wide_uniform_float(wide_high_word(bits));
    u[1] = wide_uniform_float(wide_low_word(bits));
}

const struct sampler_type sampler_independent = {
    .entry = {.name = "independent", .help = "independent random numbers (plain Monte Carlo)",
              .params = params, .size = sizeof(struct sampler_settings)},
    .next_1d = next_1d, .next_2d = next_2d, .draw_wide = draw_wide, .independent = true,
};
