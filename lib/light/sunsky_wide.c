// SPDX-License-Identifier: Apache-2.0
// Aiming at sun and sky for a lit point a lane: aim of sunsky.c, operation by operation. Only the
// search in the sky's table goes lane by lane.
#include "light/sunsky.h"
#include "light/turn.h"
#include "math/wide_maps.h"

static wide safe_sqrt_wide(wide x) {
    return wide_sqrt(wide_max(x, wide_of(0)));
}

static wide turn_of_wide(wide y, wide x) {
    const wide none = {0}, ax = wide_abs(x), ay = wide_abs(y);
    const wide small = wide_min(ax, ay), big = wide_max(ax, ay);
    const wide_mask upper = small > 0.41421356f * big;
    const wide below = wide_select(big > 0, small / big, none);
    const wide t = wide_select(upper, (small - big) / (small + big), below), z = t * t;
    const wide p = ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z -
                   3.33329491539e-1f;
    wide turn = (p * z * t + t) * (1 / TWO_PI) + wide_select(upper, wide_of(0.125f), none);
    turn = wide_select(ay > ax, 0.25f - turn, turn);
    turn = wide_select(x < 0, 0.5f - turn, turn);
    turn = wide_select(y < 0, 1 - turn, turn);
    return wide_select(turn < 1, turn, none);
}

static struct wide3 cell_directions(wide row, wide column) {
    const wide z = row / SUNSKY_ROWS, r = safe_sqrt_wide(1 - z * z);
    wide sine, cosine;
    wide_sincos_turn(column / SUNSKY_COLUMNS, &sine, &cosine);
    return (struct wide3){r * cosine, r * sine, z};
}

static struct wide3 cone_directions(const struct sunsky *s, const wide u[2]) {
    const wide height = u[0] * s->cone_height, r = safe_sqrt_wide(height * (2 - height));
    const struct wide_frame f = {wide3_of(s->sun.s), wide3_of(s->sun.t), wide3_of(s->sun.n)};
    wide sine, cosine;
    wide_sincos_turn(u[1], &sine, &cosine);
    return wide_to_world(&f, (struct wide3){r * cosine, r * sine, 1 - height});
}

// Directions for the lanes that sample the sky, and its density in them. What is set lane by lane is
// set in memory: a vector would wait for each lane.
static struct wide3 sample_sky(const struct sunsky *s, uint32_t lanes, const wide u[2],
                               float density[WIDE_LANES]) {
    float row[WIDE_LANES] = {0}, column[WIDE_LANES] = {0};
    for (; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        float pmf, y, x;
        const uint32_t r = distribution_sample(&s->rows, u[1][i], &pmf, &y);
        const uint32_t c = distribution_sample(&s->columns[r], u[0][i], &pmf, &x);
        row[i] = (float)r + y;
        column[i] = (float)c + x;
        density[i] = s->density[r][c];
    }
    return cell_directions(wide_load(row), wide_load(column));
}

// sky_pdf of the lanes that sample the sun.
static void find_density(const struct sunsky *s, uint32_t lanes, struct wide3 w,
                         float density[WIDE_LANES]) {
    const wide_int row = __builtin_convertvector(w.z * SUNSKY_ROWS, wide_int);
    const wide_int column =
        __builtin_convertvector(turn_of_wide(w.y, w.x) * SUNSKY_COLUMNS, wide_int);
    for (; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        const int r = row[i] < SUNSKY_ROWS ? row[i] : SUNSKY_ROWS - 1;
        const int c = column[i] < SUNSKY_COLUMNS ? column[i] : SUNSKY_COLUMNS - 1;
        density[i] = s->density[r][c];
    }
}

static wide mixture_pdf(const struct sunsky *s, struct wide3 w, wide sky) {
    const struct wide3 chord = wide3_sub(w, wide3_of(s->sun.n));
    const wide height = 0.5f * wide_dot(chord, chord), pdf = s->sky_share * sky;
    const wide both = pdf + (1 - s->sky_share) / (TWO_PI * s->cone_height);
    return wide_select(height > s->cone_height, pdf, both);
}

wide_mask sunsky_aim_wide(const void *data, const struct wide3 *p, const wide u[2],
                          struct light_samples *out) {
    const struct sunsky *s = data;
    const float share = s->sky_share;
    const struct wide3 none = {0};
    (void)p;
    if (s->dark)
        return wide_mask_of(0);
    const wide_mask sky = u[0] < share;
    const wide x = wide_select(sky, u[0] / share, (u[0] - share) / (1 - share));
    const wide inside[2] = {wide_min(x, wide_of(0x1.fffffep-1f)), u[1]};
    float density[WIDE_LANES] = {0};
    struct wide3 w = cone_directions(s, inside);
    if (wide_any(sky))
        w = wide3_select(sky, sample_sky(s, wide_bits(sky), inside, density), w);
    w = wide_normalize(w);
    const wide_mask above = w.z >= 0;
    if (share > 0)
        find_density(s, wide_bits(above & ~sky), w, density);
    const struct wide_frame world = {wide3_of(s->world.x), wide3_of(s->world.y),
                                     wide3_of(s->world.z)};
    *out = (struct light_samples){.wi = wide_to_world(&world, w), .p = none, .p_error = none,
                                  .n = none, .emission = none, .distance = wide_of(INFINITY),
                                  .pdf_sa = mixture_pdf(s, w, wide_load(density))};
    return above & (out->pdf_sa > 0);
}
