// SPDX-License-Identifier: Apache-2.0
// Sobol points dealt to the pixels along a space-filling curve, so that the error of neighbouring
// pixels differs as blue noise does (Ahmed and Wonka 2020, Screen-space Blue-noise Diffusion of Monte
// Carlo Sampling Error via Hierarchical Ordering of Pixels).
//
// Every 2-D draw is one Owen-scrambled (0,2)-sequence over the whole picture: sample i of a pixel of
// Morton number m takes point m 2^k + i, 2^k the samples of a pixel, the base-4 digits permuted at
// random by all digits above them. Any square of 2^n x 2^n pixels thus shares a well-laid set of
// points, and so does each pixel. Of use where few samples meet the eye or a filter; the error of a
// pixel is that of `sobol`.
#include "sampler/owen.h"
#include "sampler/sampler.h"

static const struct param params[] = {
    SAMPLER_PARAMS,
    {"randomization", PARAM_IGNORED, .unit = "", .help = "always scrambled; set by --seed"},
    PARAM_END,
};

// Bits of x at even places.
static uint64_t spread(uint32_t x) {
    uint64_t v = x & 0xffff;
    v = (v | v << 8) & 0x00ff00ff;
    v = (v | v << 4) & 0x0f0f0f0f;
    v = (v | v << 2) & 0x33333333;
    return (v | v << 1) & 0x55555555;
}

static uint32_t permuted_digit(uint64_t digit, uint64_t above, uint32_t seed) {
    // The 24 orders of four digits, two bits each.
    static const uint8_t orders[24] = {
        0xe4, 0xb4, 0xd8, 0x78, 0x9c, 0x6c, 0xe1, 0xb1, 0xc9, 0x39, 0x8d, 0x2d,
        0xd2, 0x72, 0xc6, 0x36, 0x4e, 0x1e, 0x93, 0x63, 0x87, 0x27, 0x4b, 0x1b};
    const uint64_t h = hash_u64(above ^ (uint64_t)seed << 32);
    return orders[(uint32_t)(h >> 32) * (uint64_t)24 >> 32] >> (2 * digit) & 3;
}

// Bits of the samples of a pixel.
static int sample_bits(const struct sampler *s) {
    return s->count > 1 ? 32 - __builtin_clz(s->count - 1) : 0;
}

// The point of this sample, for the draw with this seed. Where the samples are an odd power of two,
// the lowest bit stands alone, so that no digit mixes samples and pixels.
static uint32_t point_index(const struct sampler *s, int bits, uint32_t seed) {
    const uint64_t curve = spread(s->pixel & 0xffff) | spread(s->pixel >> 16) << 1;
    const uint64_t place = curve << bits | (s->index & (((uint64_t)1 << bits) - 1));
    const int first = bits % 2;
    uint32_t index = first ? (uint32_t)(place ^ hash_u64(place >> 1 ^ (uint64_t)seed << 32)) & 1 : 0;
    for (int shift = first; shift < 32; shift += 2)
        index |= permuted_digit(place >> shift & 3, place >> (shift + 2), seed + (uint32_t)shift)
                 << shift;
    return index;
}

struct draw {
    uint32_t index;
    uint64_t scramble;
};

// Samples beyond those that were announced are scrambled anew.
static struct draw next(struct sampler *s) {
    const int bits = sample_bits(s);
    const uint64_t round = (uint64_t)s->index >> bits;
    const uint64_t d = hash_u64(((uint64_t)s->picture << 32 | s->dimension++) +
                                round * 0x9e3779b97f4a7c15u);
    return (struct draw){point_index(s, bits, (uint32_t)d), hash_u64(d)};
}

static float next_1d(struct sampler *s) {
    const struct draw d = next(s);
    return uniform_float(reverse_bits(owen_scramble_reversed(d.index, (uint32_t)d.scramble)));
}

static struct vec2 next_2d(struct sampler *s) {
    const struct draw d = next(s);
    const uint32_t x = owen_scramble_reversed(d.index, (uint32_t)d.scramble);
    const uint32_t y = owen_scramble_reversed(sobol_second_reversed(d.index), (uint32_t)(d.scramble >> 32));
    return (struct vec2){uniform_float(reverse_bits(x)), uniform_float(reverse_bits(y))};
}

const struct sampler_type sampler_zsobol = {
    .entry = {.name = "zsobol", .help = "Sobol points whose error is blue noise over the picture "
                                        "(Ahmed and Wonka 2020)",
              .params = params, .size = sizeof(struct sampler_settings)},
    .next_1d = next_1d, .next_2d = next_2d, .counted = true, .ties_pixels = true,
};
