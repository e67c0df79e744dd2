// SPDX-License-Identifier: Apache-2.0
// Owen-scrambled Sobol points: every 2-D draw is a (0,2)-sequence of its own, with its own order of
// the points, so that any number of dimensions can be padded together (Burley 2020, Practical
// Hash-based Owen Scrambling, JCGT 9(4)).
// Any aligned block of 2^k points of a draw is a (0,2)-net, as of progressive multi-jittered (0,2)
// sequences (Christensen, Kensler, Kilpatrick 2018), which this therefore also stands for. All words
// below are kept reversed where that saves a reversal (sampler/owen.h).
#include "sampler/owen.h"
#include "sampler/sampler.h"

static const struct param params[] = {
    SAMPLER_PARAMS,
    {"scramble", PARAM_IGNORED, .unit = "", .help = "always scrambled; set by --seed"},
    {"dimension", PARAM_IGNORED, .unit = "", .help = "dimensions are not limited"},
    PARAM_END,
};

static const char *const aliases[] = {"ldsampler", "halton", "hammersley", "orthogonal", "pmj02",
                                      "pmj02bn", NULL};

// Two words at once; they change places.
static uint64_t reverse_both(uint64_t x) {
    x = __builtin_bswap64(x);
    x = (x >> 4 & 0x0f0f0f0f0f0f0f0fu) | (x & 0x0f0f0f0f0f0f0f0fu) << 4;
    x = (x >> 2 & 0x3333333333333333u) | (x & 0x3333333333333333u) << 2;
    return (x >> 1 & 0x5555555555555555u) | (x & 0x5555555555555555u) << 1;
}

struct seeds {
    uint32_t order, x, y;
};

static struct seeds next_seeds(struct sampler *s) {
    const uint64_t a = hash_u64((uint64_t)s->seed << 32 | s->dimension++);
    const uint64_t b = a * 0xd1342543de82ef95u; // its top bits depend on all of a
    return (struct seeds){(uint32_t)a, (uint32_t)(a >> 32), (uint32_t)(b >> 32)};
}

// This dimension's order of the points: the index is scrambled as if it were a point.
static uint32_t shuffled_index(const struct sampler *s, uint32_t seed) {
    return reverse_bits(owen_scramble_reversed(s->reversed, seed));
}

static float next_1d(struct sampler *s) {
    const struct seeds k = next_seeds(s);
    const uint32_t index = shuffled_index(s, k.order);
    return uniform_float(reverse_bits(owen_scramble_reversed(index, k.x)));
}

static struct vec2 next_2d(struct sampler *s) {
    const struct seeds k = next_seeds(s);
    const uint32_t index = shuffled_index(s, k.order);
    // The first dimension is the reversed index, so its reversal is the index itself.
    const uint32_t x = owen_scramble_reversed(index, k.x);
    const uint32_t y = owen_scramble_reversed(sobol_second_reversed(index), k.y);
    const uint64_t both = reverse_both((uint64_t)x << 32 | y);
    return (struct vec2){uniform_float((uint32_t)both), uniform_float((uint32_t)(both >> 32))};
}

static wide_uint reverse_wide(wide_uint x) {
    x = x >> 16 | x << 16;
    x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

static void draw_wide(const struct sampler_lanes *s, wide_uint dimension, wide u[2]) {
    const struct wide_u64 a = wide_hash_u64(wide_join(s->seed, dimension));
    const struct wide_u64 b = {a.a * 0xd1342543de82ef95u, a.b * 0xd1342543de82ef95u};
    const wide_uint index = reverse_wide(owen_scramble_reversed_wide(s->reversed, wide_low_word(a)));
    const wide_uint x = owen_scramble_reversed_wide(index, wide_high_word(a));
    const wide_uint y =
        owen_scramble_reversed_wide(sobol_second_reversed_wide(index), wide_high_word(b));
    u[0] = wide_uniform_float(reverse_wide(x));
    u[1] = wide_uniform_float(reverse_wide(y));
}

const struct sampler_type sampler_sobol = {
    .entry = {.name = "sobol", .help = "Owen-scrambled Sobol points (Burley 2020)",
              .aliases = aliases, .params = params, .size = sizeof(struct sampler_settings)},
    .next_1d = next_1d, .next_2d = next_2d, .draw_wide = draw_wide,
};
