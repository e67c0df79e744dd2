// SPDX-License-Identifier: Apache-2.0
// An extensible rank-1 lattice, shifted at random for each pixel (Hickernell, Hong, L'Ecuyer,
// Lemieux 2000, Extensible lattice sequences for quasi-Monte Carlo quadrature; Cranley and Patterson
// 1976): point i is frac(phi(i) z + shift), phi(i) its bits mirrored about the point.
//
// The vector z serves LATTICE_DIMENSIONS numbers together, so that these are laid out well jointly,
// not in pairs alone; each further set of as many has an order of the points of its own. All in
// fractions of 2^32, exactly.
#include "sampler/sampler.h"

enum { LATTICE_DIMENSIONS = 64, DRAWS = LATTICE_DIMENSIONS / 2 };

static const uint32_t vector[LATTICE_DIMENSIONS] = {
#include "sampler/lattice_data.inc"
};

static const char *const aliases[] = {"rank1", NULL};

static const struct param params[] = {
    SAMPLER_PARAMS,
    {"dimension", PARAM_IGNORED, .unit = "", .help = "dimensions are not limited"},
    PARAM_END,
};

// A draw of two numbers: the first is also the draw of one. Flipped bits of the index exchange
// aligned blocks of 2^k points, each of which is a shifted lattice.
static struct vec2 next_2d(struct sampler *s) {
    const uint32_t draw = s->dimension % DRAWS, set = s->dimension / DRAWS;
    const uint64_t shift = hash_u64((uint64_t)s->seed << 32 | s->dimension++);
    const uint32_t order = set ? hash_combine(s->seed, set) : 0;
    const uint32_t phi = s->reversed ^ order;
    return (struct vec2){uniform_float(phi * vector[2 * draw] + (uint32_t)shift),
                         uniform_float(phi * vector[2 * draw + 1] + (uint32_t)(shift >> 32))};
}

static float next_1d(struct sampler *s) {
    return next_2d(s).x;
}

static wide_uint orders(wide_uint seed, wide_uint set) {
    const wide_uint order = wide_hash_combine(seed, set);
    return order & (wide_uint)(set != 0);
}

static void draw_wide(const struct sampler_lanes *s, wide_uint dimension, wide u[2]) {
    const struct wide_u64 shift = wide_hash_u64(wide_join(s->seed, dimension));
    const wide_uint phi = s->reversed ^ orders(s->seed, dimension / DRAWS);
    wide_uint z[2];
    for (int i = 0; i < WIDE_LANES; i++) {
        const uint32_t draw = dimension[i] % DRAWS;
        z[0][i] = vector[2 * draw];
        z[1][i] = vector[2 * draw + 1];
    }
    u[0] = wide_uniform_float(phi * z[0] + wide_low_word(shift));
    u[1] = wide_uniform_float(phi * z[1] + wide_high_word(shift));
}

const struct sampler_type sampler_lattice = {
    .entry = {.name = "lattice", .help = "an extensible rank-1 lattice, shifted at random",
              .aliases = aliases, .params = params, .size = sizeof(struct sampler_settings)},
    .next_1d = next_1d, .next_2d = next_2d, .draw_wide = draw_wide,
};
