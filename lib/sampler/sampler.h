// SPDX-License-Identifier: Apache-2.0
// Samplers: the random numbers of a path.
//
// Every number is a function of (pixel, sample index, dimension, seed), never of the thread. A
// sampler is a small value that the integrator carries; dimensions are consumed in order.
//
// Replicates: sample i of a pixel belongs to replicate i % replicates, as its point number
// i / replicates; replicates are scrambled independently, so the spread of their means is an honest
// error estimate also for stratified points.
#pragma once

#include "base/registry.h"
#include "math/hash.h"
#include "math/vec.h"
#include "math/wide_hash.h"

struct sampler {
    const struct sampler_type *type;
    uint32_t picture;   // seed of this replicate, the same for all pixels
    uint32_t pixel;     // x in the lower half, y in the upper
    uint32_t seed;      // of this pixel and replicate
    uint32_t index;     // point number inside the replicate
    uint32_t count;     // points a replicate will have in all (stratified kinds need it); >= 1
    uint32_t dimension; // next dimension
    uint32_t reversed;  // bits of index, mirrored
};

// The samplers of all lanes, as far as numbers depend on them.
struct sampler_lanes {
    wide_uint seed, index, reversed;
};

struct sampler_type {
    struct entry entry;
    float (*next_1d)(struct sampler *s); // in [0, 1)
    struct vec2 (*next_2d)(struct sampler *s);
    bool counted;     // points are laid out for a number of samples: others for another number
    // next_2d of each lane for the dimension given; u[0] is also next_1d. NULL: one by one.
    void (*draw_wide)(const struct sampler_lanes *s, wide_uint dimension, wide u[2]);
    bool independent; // points are independent: the running variance is a true error estimate
    bool ties_pixels; // the points of neighbouring pixels are laid out together
};

// Instance data of every sampler, and the parameters all of them take.
struct sampler_settings {
    int sample_count; // samples per pixel the file asks for; 0: none. Taken by the reader
};

#define SAMPLER_PARAMS                                                                             \
    {"sample_count", PARAM_INT, offsetof(struct sampler_settings, sample_count), .def = "0",       \
     .min = 0, .max = 1 << 30, .unit = "", .help = "samples per pixel, unless --spp is given"},   \
    {"seed", PARAM_IGNORED, .unit = "", .help = "set by --seed"}

#define X(name) extern const struct sampler_type sampler_##name;
#include "sampler/list.h"
#undef X

extern const struct registry samplers;

static inline uint32_t reverse_bits(uint32_t x) {
    x = __builtin_bswap32(x);
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

// spp: samples the pixel will have in all; replicates: power of two, at most 16.
static inline struct sampler sampler_start(const struct sampler_type *type, uint32_t x, uint32_t y,
                                           uint32_t sample, uint32_t spp, uint32_t replicates,
                                           uint32_t seed) {
    const uint32_t replicate = sample % replicates;
    // Mixed first: the numbers of neighbouring seeds would else be the same, some columns further.
    const uint32_t picture = hash_u32(seed);
    const uint32_t h = hash_combine(hash_combine(hash_combine(picture, x), y), replicate);
    const uint32_t count = (spp + replicates - 1) / replicates;
    const uint32_t index = sample / replicates;
    return (struct sampler){type, picture + replicate * 0x9e3779b9u, (x & 0xffff) | y << 16, h, index,
                            count ? count : 1, 0, reverse_bits(index)};
}

// Goes on as one of `parts` paths that share what was drawn so far, each with its point of a set so
// many times as large.
static inline void sampler_split(struct sampler *s, uint32_t part, uint32_t parts) {
    s->index = s->index * parts + part;
    s->count *= parts;
    s->reversed = reverse_bits(s->index);
}

static inline float sampler_1d(struct sampler *s) {
    return s->type->next_1d(s);
}

static inline struct vec2 sampler_2d(struct sampler *s) {
    return s->type->next_2d(s);
}
